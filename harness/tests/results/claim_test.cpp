#include "fixture.h"
#include "volmark/error.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>

namespace volmark::results_test {
namespace {

void makeOlder(const fs::path& file, double seconds) {
  fs::last_write_time(file,
                      fs::file_time_type::clock::now() - std::chrono::milliseconds(static_cast<int>(seconds * 1e3)));
}

double ageOf(const fs::path& file) {
  return std::chrono::duration<double>(fs::file_time_type::clock::now() - fs::last_write_time(file)).count();
}

void writeClaim(const fs::path& file, const std::string& host, int pid) {
  std::ofstream(file) << nlohmann::json{
      {"format", "volmark.claim"}, {"version", 1}, {"host", host}, {"pid", pid}, {"started", utcNow()}};
}

int pidThatIsGone() {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  return child;
}

/// Starts `count` processes that claim at the same moment and hold on; how many of them got it.
int winnersOf(const fs::path& file, int count) {
  int start[2], answers[2], end[2];
  if (pipe(start) != 0 || pipe(answers) != 0 || pipe(end) != 0) return -1;
  std::vector<pid_t> children;
  for (int i = 0; i < count; ++i) {
    const pid_t child = fork();
    if (child == 0) {
      close(start[1]);
      close(end[1]);
      char byte = 0;
      [[maybe_unused]] auto ignored = read(start[0], &byte, 1); // until the parent closes it
      const auto claim = Claim::take(file);
      byte = claim ? '1' : '0';
      ignored = write(answers[1], &byte, 1);
      ignored = read(end[0], &byte, 1);
      _exit(0); // without releasing: like a crash
    }
    children.push_back(child);
  }
  close(start[0]);
  close(end[0]);
  close(start[1]);
  int winners = 0;
  for (int i = 0; i < count; ++i) {
    char byte = 0;
    if (read(answers[0], &byte, 1) == 1 && byte == '1') ++winners;
  }
  close(end[1]);
  for (pid_t child : children)
    waitpid(child, nullptr, 0);
  close(answers[0]);
  close(answers[1]);
  return winners;
}

TEST(Claim, isExclusiveUntilReleased) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  {
    const auto first = Claim::take(file);
    ASSERT_TRUE(first);
    EXPECT_FALSE(Claim::take(file));
    const auto text = readJson(file);
    ASSERT_TRUE(text);
    EXPECT_EQ(text->at("format"), "volmark.claim");
    EXPECT_EQ(text->at("version"), 1);
    EXPECT_EQ(text->at("pid"), getpid());
    EXPECT_EQ(text->at("host"), hostName());
  }
  EXPECT_FALSE(fs::exists(file));
  EXPECT_TRUE(Claim::take(file));
}

TEST(Claim, beatRefreshesTheHeartbeat) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  const auto claim = Claim::take(file);
  makeOlder(file, 50);
  EXPECT_TRUE(claim->beat());
  EXPECT_LT(ageOf(file), 5);
}

TEST(Claim, ofALivingProcessIsRespected) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  for (const auto& [host, pid] : {std::pair{hostName(), int(getppid())}, {std::string("elsewhere"), pidThatIsGone()}}) {
    writeClaim(file, host, pid);
    makeOlder(file, 50);
    EXPECT_FALSE(Claim::take(file)) << host;
  }
}

TEST(Claim, ofAProcessThatIsGoneIsTakenOver) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  writeClaim(file, hostName(), pidThatIsGone());
  EXPECT_TRUE(Claim::take(file));
  EXPECT_FALSE(fs::exists(file));
}

TEST(Claim, withoutHeartbeatIsTakenOver) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  for (const std::string text : {"claim of another host", "", "{\"format\": \"volmark.cl", "[1, 2]"}) {
    std::ofstream(file) << text;
    EXPECT_FALSE(Claim::take(file)) << text;
    makeOlder(file, kClaimLifetimeSeconds + 5);
    const auto claim = Claim::take(file);
    ASSERT_TRUE(claim) << text;
    EXPECT_LT(ageOf(file), 5);
  }
}

// A process that slept through its lifetime must not disturb the one that took its run over.
TEST(Claim, thatWasLostLeavesTheNewOwnerAlone) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  auto sleeper = Claim::take(file);
  writeClaim(file, "elsewhere", 1);
  const std::string taken = readText(file);
  makeOlder(file, 30);
  EXPECT_FALSE(sleeper->beat());
  EXPECT_GT(ageOf(file), 20);
  sleeper.reset();
  EXPECT_EQ(readText(file), taken);
}

TEST(Claim, isKeptWhenAForkEnds) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  auto claim = Claim::take(file);
  const pid_t child = fork();
  if (child == 0) {
    claim.reset();
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(fs::exists(file));
}

TEST(Claim, raceForANewRunHasOneWinner) {
  const TemporaryFolder folder;
  for (int round = 0; round < 60; ++round)
    ASSERT_EQ(winnersOf(folder.path() / fmt::format("{}.claim", round), 2 + round % 4), 1) << round;
}

TEST(Claim, raceForAnAbandonedRunHasOneWinner) {
  const TemporaryFolder folder;
  for (int round = 0; round < 60; ++round) {
    const fs::path file = folder.path() / fmt::format("{}.claim", round);
    writeClaim(file, "elsewhere", 1);
    makeOlder(file, kClaimLifetimeSeconds + 5);
    ASSERT_EQ(winnersOf(file, 2 + round % 4), 1) << round;
  }
}

TEST(Claim, thatCannotBeWrittenIsOneLine) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "x";
  try {
    Claim::take(folder.path() / "file" / "run.claim");
    FAIL();
  } catch (const DeviceError& error) {
    EXPECT_EQ(std::string(error.what()),
              (folder.path() / "file" / "run.claim").string() + ": can't be written: Not a directory");
  }
}

} // namespace
} // namespace volmark::results_test
