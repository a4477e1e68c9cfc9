#include "fixture.h"
#include "volmark/error.h"

#include <gmock/gmock.h>

#include <csignal>
#include <sys/resource.h>
#include <sys/wait.h>

namespace volmark::results_test {
namespace {

using testing::HasSubstr;
using testing::UnorderedElementsAre;

std::string errorOf(const fs::path& results, const Scenario& scenario) {
  try {
    const Experiment experiment(results, scenario);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Experiment, writesWhatTheScenarioIs) {
  const TemporaryFolder folder;
  const Experiment experiment(folder.path() / "new" / "results", makeScenario());
  const auto document = readJson(experiment.folder() / "experiment.json");
  ASSERT_TRUE(document);
  EXPECT_EQ(experiment.folder(), folder.path() / "new" / "results" / "quick");
  EXPECT_EQ(document->at("format"), "volmark.experiment");
  EXPECT_EQ(document->at("version"), 1);
  EXPECT_EQ(document->at("config_file"), "quick.json");
  EXPECT_EQ(document->at("axes"), nlohmann::json({"technique", "step"}));
  EXPECT_EQ(document->at("points").size(), 4u);
  EXPECT_EQ(document->at("points")[2]["index"], 2);
  EXPECT_EQ(document->at("points")[2]["labels"]["technique"], "fake_b");
  EXPECT_EQ(document->at("program").size(), 2u);
  EXPECT_THAT(namesIn(experiment.folder()), UnorderedElementsAre("experiment.json"));
}

TEST(Experiment, mayGrow) {
  const TemporaryFolder folder;
  const Experiment first(folder.path(), makeScenario());
  const auto before = readJson(first.folder() / "experiment.json");
  Scenario larger = makeScenario();
  larger.points.push_back(makePointOf("fake_a", 2));
  const Experiment second(folder.path(), larger);
  const auto after = readJson(second.folder() / "experiment.json");
  EXPECT_EQ(after->at("points").size(), 5u);
  EXPECT_EQ(after->at("created"), before->at("created"));
}

TEST(Experiment, refusesWhatIsNotItsOwn) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "quick" / "experiment.json";
  fs::create_directories(file.parent_path());
  for (const auto& [text, place] :
       {std::pair{R"({"format": "volmark.experiment", "version": 2, "name": "quick"})",
                  "/version: found 2, allowed: 1"},
        {R"({"format": "volmark.experiment", "name": "quick"})", "/version: found null, allowed: 1"},
        {R"({"format": "volmark.experiment", "version": 1, "name": "slow"})",
         "/name: found \"slow\", allowed: \"quick\""},
        {R"({"format": "else", "version": 1, "name": "quick"})", "/format: found \"else\""},
        {"not json", "found something that isn't an experiment"}}) {
    std::ofstream(file) << text;
    const std::string error = errorOf(folder.path(), makeScenario());
    EXPECT_THAT(error, HasSubstr(file.string() + ": " + place));
    EXPECT_EQ(error.find('\n'), std::string::npos);
    EXPECT_EQ(readText(file), text) << "must stay as it was";
    EXPECT_THAT(namesIn(file.parent_path()), UnorderedElementsAre("experiment.json"));
  }
}

TEST(Experiment, thatCannotBeWrittenIsOneLineAndLeavesNothing) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "x";
  EXPECT_EQ(errorOf(folder.path() / "file" / "results", makeScenario()),
            (folder.path() / "file" / "results" / "quick").string() + ": can't be written: Not a directory");
  EXPECT_THAT(namesIn(folder.path()), UnorderedElementsAre("file"));

  // A folder where the file should be: found out only after the folders above it were made.
  fs::create_directories(folder.path() / "results" / "quick" / "experiment.json" / "x");
  EXPECT_THAT(errorOf(folder.path() / "results", makeScenario()), HasSubstr("experiment.json"));
  EXPECT_THAT(namesIn(folder.path() / "results" / "quick"), UnorderedElementsAre("experiment.json"));

  // A device without folders, even for root.
  EXPECT_THAT(errorOf("/proc/self/volmark", makeScenario()), HasSubstr("/proc/self/volmark/quick: can't be written: "));
}

// The folders can be made, the file can't: they go again.
TEST(Experiment, onAFullDiskTakesItsFoldersBack) {
  const TemporaryFolder folder;
  const pid_t child = fork();
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{16, 16};
    setrlimit(RLIMIT_FSIZE, &limit);
    const std::string error = errorOf(folder.path() / "new" / "results", makeScenario());
    _exit(error.find("can't be written: File too large") != std::string::npos ? 7 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_THAT(namesIn(folder.path()), testing::IsEmpty());
}

TEST(Experiment, knowsTheStatusOfItsRuns) {
  const TemporaryFolder folder;
  const Scenario scenario = makeScenario();
  const Experiment experiment(folder.path(), scenario);
  const TechniqueFactory factory = fakeFactory("fake_a");
  const RunIdentity identity = identityOf(scenario.points[0]);
  EXPECT_FALSE(experiment.statusOf(identity));
  for (RunStatus status : {RunStatus::crashed, RunStatus::timedOut, RunStatus::unsupported, RunStatus::outOfMemory,
                           RunStatus::failed, RunStatus::completed}) {
    RunRecord record = makeRecord();
    record.status = status;
    experiment.stage(identity);
    experiment.commit(identity, scenario.points[0], entryOf(factory), record);
    EXPECT_EQ(experiment.statusOf(identity), nameOf(status));
  }
  const fs::path file = experiment.runFolder(identity) / "run.json";
  std::ofstream(file) << "{\"half\": ";
  EXPECT_FALSE(experiment.statusOf(identity));
  std::ofstream(file) << R"({"format": "volmark.run", "version": 2, "status": "completed"})";
  EXPECT_THROW(experiment.statusOf(identity), InputError);
  EXPECT_THROW(experiment.writeIndex(), InputError);
}

TEST(Experiment, claimsAreSeenByOthers) {
  const TemporaryFolder folder;
  const Scenario scenario = makeScenario();
  const Experiment one(folder.path(), scenario), other(folder.path(), scenario);
  const RunIdentity identity = identityOf(scenario.points[0]);
  auto claim = one.claim(identity);
  ASSERT_TRUE(claim);
  EXPECT_FALSE(other.claim(identity));
  EXPECT_TRUE(other.claim(identityOf(scenario.points[1])));
  claim.reset();
  EXPECT_TRUE(other.claim(identity));
}

TEST(Experiment, stageIsEmptyAndRemovesLeftovers) {
  const TemporaryFolder folder;
  const Scenario scenario = makeScenario();
  const Experiment experiment(folder.path(), scenario);
  const RunIdentity identity = identityOf(scenario.points[0]), other = identityOf(scenario.points[1]);
  const fs::path shelf = experiment.runFolder(identity).parent_path();
  const fs::path foreign = experiment.stage(other);
  for (const char* left : {"1", "2", "2.replaced"}) {
    fs::create_directories(shelf / fmt::format(".{}.{}", identity.run, left));
    std::ofstream(shelf / fmt::format(".{}.{}", identity.run, left) / "frames.csv") << "old";
  }
  std::ofstream(experiment.stage(identity) / "frames.csv") << "older";
  const fs::path stage = experiment.stage(identity);
  EXPECT_TRUE(fs::is_empty(stage));
  EXPECT_EQ(stage.filename(), fmt::format(".{}.{}", identity.run, getpid()));
  EXPECT_TRUE(fs::exists(foreign)) << "belongs to another run";
  std::size_t hidden = 0;
  for (const std::string& name : namesIn(shelf))
    hidden += name.starts_with("." + identity.run);
  EXPECT_EQ(hidden, 1u);
}

} // namespace
} // namespace volmark::results_test
