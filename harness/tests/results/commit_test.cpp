#include "fixture.h"
#include "measure/clocks.h"
#include "volmark/error.h"

#include <gmock/gmock.h>

#include <csignal>
#include <random>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/wait.h>

namespace volmark::results_test {
namespace {

using testing::HasSubstr;
using testing::UnorderedElementsAre;

class Commit : public testing::Test {
protected:
  TemporaryFolder folder;
  Scenario scenario = makeScenario();
  Experiment experiment{folder.path(), scenario};
  TechniqueFactory factory = fakeFactory("fake_a");
  const Point& point = scenario.points[1];
  RunIdentity identity = identityOf(point);
  fs::path runFolder = experiment.runFolder(identity);

  void commit(const RunRecord& record) { experiment.commit(identity, point, entryOf(factory), record); }
  nlohmann::json run() const { return readJson(runFolder / "run.json").value_or(nlohmann::json()); }
};

TEST_F(Commit, writesEverything) {
  RunRecord record = makeRecord();
  const fs::path stage = experiment.stage(identity);
  std::ofstream(stage / "log.txt") << "log";
  addPicture(record, stage, {.mse = 1e-5, .psnrDb = 50.0, .ssim = 0.99, .flip = 0.02, .depthMeanVoxels = 0.25});
  addPicture(record, stage, {.identical = true});
  record.pictures.push_back(record.pictures.back());
  record.pictures.back().reference = "none";
  commit(record);

  EXPECT_FALSE(fs::exists(stage));
  EXPECT_THAT(namesIn(runFolder), UnorderedElementsAre("run.json", "frames.csv", "counters.csv", "pictures.csv",
                                                       "log.txt", "frame_0.exr", "frame_1.exr"));
  const nlohmann::json run = this->run();
  EXPECT_EQ(run["format"], "volmark.run");
  EXPECT_EQ(run["version"], 1);
  EXPECT_EQ(run["run"], identity.run);
  EXPECT_EQ(run["point"], identity.point);
  EXPECT_EQ(run["point_index"], 1);
  EXPECT_EQ(run["labels"]["step"], "1.0");
  EXPECT_EQ(run["config"], point.config);
  EXPECT_EQ(run["technique"]["history"], "visible");
  EXPECT_EQ(run["technique"]["counters"][0]["kind"], "per_device");
  EXPECT_EQ(run["generation"][0]["gpu_ms"], nullptr);
  EXPECT_EQ(run["generation"][1]["gpu_ms"], 0.75);
  EXPECT_EQ(run["memory"]["total_bytes"], (1 << 20) + 4096);
  EXPECT_EQ(run["pictures"][0]["psnr_db"], 50);
  EXPECT_EQ(run["pictures"][0]["ssim"], 0.99);
  EXPECT_EQ(run["pictures"][0]["flip"], 0.02);
  EXPECT_EQ(run["pictures"][0]["flip_hdr"], nullptr);
  EXPECT_EQ(run["pictures"][0]["depth_max_voxels"], nullptr);
  EXPECT_EQ(run["pictures"][0]["cumulative_ms"], 20.125);
  EXPECT_EQ(run["pictures"][1]["psnr_db"], nullptr);
  EXPECT_EQ(run["pictures"][1]["identical"], true);
  EXPECT_EQ(run["pictures"][2]["mse"], nullptr);
  EXPECT_EQ(run["pictures"][2]["flip"], nullptr);
  EXPECT_EQ(run["pictures"][2]["identical"], nullptr);
  EXPECT_EQ(run["checks"][0]["passed"], true);
  EXPECT_EQ(run["provenance"], record.provenance);
  for (const char* name : {"frames", "counters", "pictures"})
    EXPECT_TRUE(readText(runFolder / fmt::format("{}.csv", name)).starts_with(fmt::format("# volmark.{} 1\n", name)));
}

TEST_F(Commit, statisticsAreOfHeadlineFrames) {
  const RunRecord record = makeRecord(400, 2);
  commit(record);
  const nlohmann::json statistics = run()["statistics"];
  std::vector<double> headline;
  double breakdown = 0;
  for (const FrameRow& frame : record.frames)
    if (frame.orbitKind == OrbitKind::headline)
      headline.push_back(frame.frameMs);
    else
      breakdown += frame.frameMs / 400;
  const Statistics expected = statisticsOf(headline);
  EXPECT_EQ(statistics["frames"], 800);
  EXPECT_EQ(statistics["poses"], 400);
  EXPECT_EQ(statistics["orbits"], 2);
  EXPECT_EQ(statistics["frame"]["mean_ms"], expected.meanMs) << "all digits";
  EXPECT_EQ(statistics["frame"]["low1_avg_ms"], expected.low1AvgMs);
  EXPECT_EQ(statistics["interval"]["count"], 798) << "the first frame of an orbit has no interval here";
  EXPECT_EQ(statistics["update"]["mean_ms"], 0);
  EXPECT_EQ(statistics["update"]["fps"], nullptr);
  EXPECT_EQ(statistics["gpu"], nullptr);
  EXPECT_NEAR(statistics["passes"]["march"]["mean_ms"].get<double>(), breakdown, 1e-9);
  EXPECT_EQ(statistics["passes"]["never"]["mean_ms"], 0);
  EXPECT_NEAR(statistics["stamps_ratio"].get<double>(), breakdown / expected.meanMs, 1e-12);
  EXPECT_EQ(statistics["disturbed_frames"], 2);
  EXPECT_EQ(statistics["flags"], nlohmann::json({"disturbed"}));
}

TEST_F(Commit, flagsWhatIsDoubtful) {
  RunRecord record = makeRecord(298, 1);
  for (FrameRow& frame : record.frames) {
    frame.disturbed.clear();
    frame.frameMs = frame.orbitKind == OrbitKind::breakdown ? 5.2 : 5.0;
  }
  commit(record);
  EXPECT_EQ(run()["statistics"]["flags"], nlohmann::json({"insufficient_frames", "stamps_ratio"}));
  EXPECT_NEAR(run()["statistics"]["stamps_ratio"].get<double>(), 5.2 / 5.0, 1e-12);
}

TEST_F(Commit, countersAreMeansPerFrame) {
  RunRecord record = makeRecord();
  record.counters = {{0, 0.0, {{"samples", 10}}}, {1, 0.5, {{"samples", 15}, {"extra", 4}}}};
  commit(record);
  EXPECT_EQ(run()["counters"], nlohmann::json({{"samples", 12.5}, {"extra", 4.0}}));
}

TEST_F(Commit, runThatFailedKeepsItsLogButNoPictures) {
  RunRecord record = makeRecord();
  const fs::path stage = experiment.stage(identity);
  std::ofstream(stage / "log.txt") << "log";
  addPicture(record, stage, {});
  record.status = RunStatus::crashed;
  record.reason = "segmentation fault\nin draw";
  commit(record);
  EXPECT_THAT(namesIn(runFolder),
              UnorderedElementsAre("run.json", "frames.csv", "counters.csv", "pictures.csv", "log.txt"));
  const nlohmann::json run = this->run();
  EXPECT_EQ(run["reason"], "segmentation fault in draw");
  for (const char* key : {"statistics", "generation", "counters", "memory", "pictures", "prepare_ms"})
    EXPECT_FALSE(run.contains(key)) << key;
  EXPECT_TRUE(run.contains("provenance"));
}

// The runner reports on a worker that died: what the worker staged is adopted.
TEST_F(Commit, adoptsTheStageOfADeadWorker) {
  const pid_t worker = fork();
  if (worker == 0) {
    std::ofstream(experiment.stage(identity) / "log.txt") << "last words";
    _exit(0);
  }
  waitpid(worker, nullptr, 0);
  RunRecord record = makeRecord();
  record.status = RunStatus::crashed;
  commit(record);
  EXPECT_EQ(readText(runFolder / "log.txt"), "last words");
  EXPECT_THAT(namesIn(runFolder.parent_path()), UnorderedElementsAre(identity.run));
}

TEST_F(Commit, worksWithoutAStage) {
  RunRecord record;
  record.status = RunStatus::unsupported;
  record.reason = "needs mesh shaders";
  commit(record);
  EXPECT_EQ(experiment.statusOf(identity), "unsupported");
}

TEST_F(Commit, replacesAnEarlierAttempt) {
  RunRecord record = makeRecord();
  std::ofstream(experiment.stage(identity) / "of_the_first.txt") << "x";
  record.status = RunStatus::failed;
  commit(record);
  experiment.stage(identity);
  record.status = RunStatus::completed;
  commit(record);
  EXPECT_EQ(experiment.statusOf(identity), "completed");
  EXPECT_FALSE(fs::exists(runFolder / "of_the_first.txt"));
  EXPECT_THAT(namesIn(runFolder.parent_path()), UnorderedElementsAre(identity.run));
}

TEST_F(Commit, refusesARunWithoutItsPictures) {
  RunRecord record = makeRecord();
  const fs::path stage = experiment.stage(identity);
  addPicture(record, stage, {});
  fs::remove(stage / "frame_0.exr");
  EXPECT_THROW(commit(record), std::logic_error);
  EXPECT_FALSE(fs::exists(runFolder));
}

TEST_F(Commit, onAFullDiskIsOneLineAndLeavesNothing) {
  for (const char* name : {"frames.csv", "counters.csv", "run.json"}) {
    const fs::path stage = experiment.stage(identity);
    fs::create_symlink("/dev/full", stage / name);
    try {
      commit(makeRecord());
      FAIL();
    } catch (const DeviceError& error) {
      EXPECT_EQ(std::string(error.what()), (stage / name).string() + ": can't be written: No space left on device");
    }
    EXPECT_TRUE(namesIn(runFolder.parent_path()).empty()) << name;
    EXPECT_FALSE(experiment.statusOf(identity));
  }
}

// The disk fills up in the middle of a file, after an attempt that must stay as it was.
TEST_F(Commit, thatRunsOutOfSpaceKeepsTheEarlierAttempt) {
  commit(makeRecord(4));
  const std::string before = readText(runFolder / "run.json");
  const pid_t child = fork();
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{20000, 20000};
    setrlimit(RLIMIT_FSIZE, &limit);
    experiment.stage(identity);
    try {
      commit(makeRecord(2000));
    } catch (const DeviceError&) {
      _exit(7);
    }
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_EQ(readText(runFolder / "run.json"), before);
  EXPECT_THAT(namesIn(runFolder.parent_path()), UnorderedElementsAre(identity.run));
}

// run.json is absent, or it can be parsed and all that it names is there in full.
void expectWhole(const fs::path& runFolder) {
  if (!fs::exists(runFolder / "run.json")) {
    EXPECT_FALSE(fs::exists(runFolder)) << "a folder without run.json";
    return;
  }
  const auto run = readJson(runFolder / "run.json");
  ASSERT_TRUE(run);
  const int frames = run->at("statistics").at("frames").get<int>() / 3 * 4; // three headline orbits, one breakdown
  const std::string csv = readText(runFolder / "frames.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), frames + 2);
  for (const auto& picture : run->at("pictures"))
    EXPECT_EQ(readText(runFolder / picture.at("file").get<std::string>()), "picture");
  EXPECT_TRUE(fs::exists(runFolder / "counters.csv"));
  EXPECT_TRUE(fs::exists(runFolder / "pictures.csv"));
}

[[noreturn]] void commitForEver(const Experiment& experiment, const RunIdentity& identity, const Point& point,
                                const CatalogueEntry& entry) {
  for (int frames = 10;; frames = frames % 1000 + 90) {
    RunRecord record = makeRecord(frames, 3);
    const fs::path stage = experiment.stage(identity);
    addPicture(record, stage, {.mse = 0.1});
    addPicture(record, stage, {.mse = 0.2});
    experiment.commit(identity, point, entry, record);
  }
}

TEST_F(Commit, killedAtAnyMomentLeavesNothingOrAll) {
  // Moments are drawn from the time that a few commits take here.
  const RunRecord record = makeRecord(500);
  const double begin = monotonicMs();
  commit(record);
  const double lifeMs = std::clamp(4 * (monotonicMs() - begin), 2.0, 60.0);
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> delayMs(0, lifeMs);
  for (int kills = 0; kills < 40 && !HasFailure(); ++kills) {
    // Half of the kills meet the first attempt, half a replacement.
    if (kills % 2 == 0) fs::remove_all(runFolder);
    const pid_t child = fork();
    if (child == 0) commitForEver(experiment, identity, point, entryOf(factory));
    usleep(static_cast<useconds_t>(delayMs(engine) * 1000));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    expectWhole(runFolder);
    experiment.writeIndex();
  }
  fs::remove(experiment.stage(identity));
  for (const std::string& name : namesIn(runFolder.parent_path()))
    EXPECT_EQ(name, identity.run) << "stage() removes what dead attempts left";
}

/// A child that stops itself before it commits. Returns its pid, or -1 if processes can't be traced here.
pid_t startTraced(const Experiment& experiment, const RunIdentity& identity, const Point& point,
                  const CatalogueEntry& entry) {
  RunRecord record = makeRecord(10, 3);
  const pid_t child = fork();
  if (child == 0) {
    const fs::path stage = experiment.stage(identity);
    addPicture(record, stage, {.mse = 0.1});
    if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(1);
    raise(SIGSTOP);
    experiment.commit(identity, point, entry, record);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSTOPPED(status) ? child : -1;
}

/// Lets a traced child pass `stops` entries to and returns from the kernel, then kills it. False if it ended before,
/// which must be because it was done.
bool killAfter(pid_t child, int stops) {
  int status = 0;
  for (int i = 0; i < stops; ++i) {
    ptrace(PTRACE_SYSCALL, child, nullptr, nullptr);
    waitpid(child, &status, 0);
    if (WIFSTOPPED(status)) continue;
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
    return false;
  }
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
  return true;
}

// What other processes see changes only in system calls: a kill before and after each of them meets every state.
TEST_F(Commit, killedAtAnySystemCallLeavesNothingOrAll) {
  for (const bool replaces : {false, true}) {
    int stops = 0, whole = 0;
    for (bool wasKilled = true; wasKilled && !HasFailure(); ++stops) {
      fs::remove_all(runFolder);
      if (replaces) commit(makeRecord(5));
      const pid_t child = startTraced(experiment, identity, point, entryOf(factory));
      if (child < 0) GTEST_SKIP() << "processes can't be traced here";
      wasKilled = killAfter(child, stops);
      expectWhole(runFolder);
      whole += fs::exists(runFolder);
    }
    EXPECT_GT(stops, 50);
    EXPECT_GT(whole, 1);
#ifndef __SANITIZE_ADDRESS__ // whose own calls come and go, so that the sweep may step over one of the commit's
    EXPECT_LT(whole, stops) << "replaces: " << replaces;
#endif
  }
}

} // namespace
} // namespace volmark::results_test
