#include "fixture.h"
#include "volmark/error.h"

#include <csignal>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>

namespace volmark::results_test {
namespace {

void makeOlder(const fs::path& file, double seconds) {
  fs::last_write_time(file,
                      fs::file_time_type::clock::now() - std::chrono::milliseconds(static_cast<int>(seconds * 1e3)));
}

double ageOf(const fs::path& file) {
  return std::chrono::duration<double>(fs::file_time_type::clock::now() - fs::last_write_time(file)).count();
}

/// What this process would claim, with another host, process or start.
nlohmann::json claimBy(const std::string& host, int pid, const std::string& processStarted = "") {
  const TemporaryFolder folder;
  ClaimWatch watch;
  const auto own = Claim::take(folder.path() / "own.claim", watch);
  nlohmann::json claim = *readJson(folder.path() / "own.claim");
  claim["host"] = host;
  claim["pid"] = pid;
  if (!processStarted.empty()) claim["process_started"] = processStarted;
  return claim;
}

void writeClaim(const fs::path& file, const std::string& host, int pid) {
  std::ofstream(file) << claimBy(host, pid);
}

std::unique_ptr<Claim> takeAtOnce(const fs::path& file) {
  ClaimWatch watch;
  return Claim::take(file, watch);
}

constexpr std::chrono::milliseconds kShortLife{60};

/// Takes with a watch that has seen the claim for its whole, short life.
std::unique_ptr<Claim> takeAfterWatching(const fs::path& file) {
  ClaimWatch watch(kShortLife);
  auto claim = Claim::take(file, watch);
  if (claim) return claim;
  std::this_thread::sleep_for(kShortLife + std::chrono::milliseconds(5));
  return Claim::take(file, watch);
}

int pidThatIsGone() {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  return child;
}

/// Starts `count` processes that claim at the same moment and hold on; how many of them got it.
int winnersOf(const fs::path& file, int count, bool watched) {
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
      const auto claim = watched ? takeAfterWatching(file) : takeAtOnce(file);
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
    const auto first = takeAtOnce(file);
    ASSERT_TRUE(first);
    EXPECT_FALSE(takeAtOnce(file));
    const auto text = readJson(file);
    ASSERT_TRUE(text);
    EXPECT_EQ(text->at("format"), "volmark.claim");
    EXPECT_EQ(text->at("version"), 1);
    EXPECT_EQ(text->at("pid"), getpid());
    EXPECT_EQ(text->at("host"), hostName());
  }
  EXPECT_FALSE(fs::exists(file));
  EXPECT_TRUE(takeAtOnce(file));
}

TEST(Claim, beatRefreshesTheHeartbeat) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  const auto claim = takeAtOnce(file);
  makeOlder(file, 50);
  EXPECT_TRUE(claim->beat());
  EXPECT_LT(ageOf(file), 5);
}

// Whatever the clocks say: those of two machines may differ, and one may be set while a grid runs.
TEST(Claim, ofALivingProcessIsRespectedAtAnyAge) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  const auto own = takeAtOnce(file);
  for (const double age : {0.0, 1e6, -1e6}) {
    makeOlder(file, age);
    EXPECT_FALSE(takeAfterWatching(file)) << age;
  }
}

TEST(Claim, ofAnotherMachineIsRespectedAtAnyAgeUntilItWasWatched) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  writeClaim(file, "elsewhere", pidThatIsGone());
  for (const double age : {0.0, 1e6, -1e6}) {
    makeOlder(file, age);
    EXPECT_FALSE(takeAtOnce(file)) << age;
  }
  EXPECT_TRUE(takeAfterWatching(file));
}

TEST(Claim, ofAnotherMachineThatBeatsIsRespected) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  writeClaim(file, "elsewhere", 1);
  ClaimWatch watch(kShortLife);
  EXPECT_FALSE(Claim::take(file, watch));
  EXPECT_TRUE(watch.isUndecided());
  for (int beat = 1; beat <= 5; ++beat) {
    std::this_thread::sleep_for(kShortLife / 2);
    makeOlder(file, 1000 - beat);
    EXPECT_FALSE(Claim::take(file, watch)) << beat;
    EXPECT_FALSE(watch.isUndecided());
  }
}

TEST(Claim, ofAProcessThatIsGoneIsTakenOver) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  writeClaim(file, hostName(), pidThatIsGone());
  EXPECT_TRUE(takeAtOnce(file));
  EXPECT_FALSE(fs::exists(file));
}

TEST(Claim, ofAProcessThatHasEndedIsTakenOverThoughNobodyWaitedForIt) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  const pid_t child = fork();
  if (child == 0) {
    ClaimWatch watch;
    auto claim = Claim::take(file, watch);
    kill(getpid(), SIGKILL);
  }
  siginfo_t ended;
  waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT); // it stays a zombie
  EXPECT_TRUE(takeAtOnce(file));
  waitpid(child, nullptr, 0);
}

// Process numbers come back: one that started at another time is another process.
TEST(Claim, ofAnEarlierProcessOfTheSameNumberIsTakenOver) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  std::ofstream(file) << claimBy(hostName(), getpid(), "12");
  EXPECT_TRUE(takeAtOnce(file));
}

TEST(Claim, withoutAReadableOwnerIsTakenOverOnceItWasWatched) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  for (const std::string text : {"claim of another host", "", "{\"format\": \"volmark.cl", "[1, 2]"}) {
    std::ofstream(file) << text;
    EXPECT_FALSE(takeAtOnce(file)) << text;
    const auto claim = takeAfterWatching(file);
    ASSERT_TRUE(claim) << text;
    EXPECT_LT(ageOf(file), 5);
  }
}

// A process that slept through its lifetime must not disturb the one that took its run over.
TEST(Claim, thatWasLostLeavesTheNewOwnerAlone) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  auto sleeper = takeAtOnce(file);
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
  auto claim = takeAtOnce(file);
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
    ASSERT_EQ(winnersOf(folder.path() / fmt::format("{}.claim", round), 2 + round % 4, false), 1) << round;
}

TEST(Claim, raceForAnAbandonedRunHasOneWinner) {
  const TemporaryFolder folder;
  const nlohmann::json gone = claimBy(hostName(), pidThatIsGone());
  const nlohmann::json elsewhere = claimBy("elsewhere", 1);
  for (int round = 0; round < 60; ++round) {
    const fs::path file = folder.path() / fmt::format("{}.claim", round);
    std::ofstream(file) << (round % 3 == 0 ? elsewhere : gone);
    ASSERT_EQ(winnersOf(file, 2 + round % 4, round % 3 == 0), 1) << round;
  }
}

TEST(Claim, tellsPeopleWhoHasIt) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.claim";
  {
    const auto claim = takeAtOnce(file);
    const ClaimFacts facts = readClaim(file);
    EXPECT_EQ(facts.host, hostName());
    EXPECT_EQ(facts.pid, getpid());
    EXPECT_TRUE(facts.active);
    EXPECT_LT(facts.heartbeatSeconds, 5);
  }
  EXPECT_FALSE(readClaim(file).active);
  writeClaim(file, hostName(), pidThatIsGone());
  EXPECT_FALSE(readClaim(file).active);
  writeClaim(file, "elsewhere", 1);
  EXPECT_TRUE(readClaim(file).active);
  makeOlder(file, 100);
  EXPECT_FALSE(readClaim(file).active);
}

TEST(Claim, thatCannotBeWrittenIsOneLine) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "x";
  try {
    takeAtOnce(folder.path() / "file" / "run.claim");
    FAIL();
  } catch (const DeviceError& error) {
    EXPECT_EQ(std::string(error.what()),
              (folder.path() / "file" / "run.claim").string() + ": can't be written: Not a directory");
  }
}

} // namespace
} // namespace volmark::results_test
