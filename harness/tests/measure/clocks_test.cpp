#include "measure/clocks.h"

#include <gtest/gtest.h>

#include <csignal>
#include <sched.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace volmark {
namespace {

void spinFor(double ms) {
  const double end = monotonicMs() + ms;
  while (monotonicMs() < end) {
  }
}

TEST(Clocks, monotonicNeverGoesBack) {
  double previous = monotonicMs();
  for (int i = 0; i < 10000; ++i) {
    const double now = monotonicMs();
    ASSERT_GE(now, previous);
    previous = now;
  }
}

TEST(Clocks, sleepingTakesWallTimeButNoCpuTime) {
  const double wall = monotonicMs(), cpu = processCpuMs();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_GE(monotonicMs() - wall, 50);
  EXPECT_LT(processCpuMs() - cpu, 25);
}

TEST(Clocks, cpuTimeCountsAllThreads) {
  const double cpu = processCpuMs();
  double spentMs = 0; // by the other thread's own clock: independent of how busy the machine is
  std::thread([&spentMs] {
    timespec time{};
    while (spentMs < 40) {
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
      spentMs = static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
    }
  }).join();
  EXPECT_GE(processCpuMs() - cpu, spentMs * 0.95);
}

TEST(Disturbance, countersNeverGoBack) {
  const DisturbanceMonitor monitor;
  DisturbanceCounters previous = monitor.read();
  for (int i = 0; i < 200; ++i) {
    spinFor(0.2);
    const DisturbanceCounters now = monitor.read();
    ASSERT_GE(now.involuntarySwitches, previous.involuntarySwitches);
    ASSERT_GE(now.pressureUs, previous.pressureUs);
    ASSERT_GE(now.stealTicks, previous.stealTicks);
    previous = now;
  }
}

TEST(Disturbance, readingTakesMicroseconds) {
  const DisturbanceMonitor monitor;
  const double cpu = processCpuMs();
  for (int i = 0; i < 200; ++i)
    monitor.read();
  EXPECT_LT((processCpuMs() - cpu) / 200, 0.5);
}

// Two busy processes on one CPU: each must be preempted within some time slices.
TEST(Disturbance, seesACompetingProcess) {
  cpu_set_t before, one;
  ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
  CPU_ZERO(&one);
  CPU_SET(sched_getcpu(), &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);

  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0)
    for (;;) {
    }
  const DisturbanceMonitor monitor;
  const DisturbanceCounters start = monitor.read();
  const double begin = monotonicMs();
  DisturbanceCounters now = start;
  while (now.involuntarySwitches == start.involuntarySwitches && monotonicMs() - begin < 3000) {
    spinFor(20);
    now = monitor.read();
  }
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  sched_setaffinity(0, sizeof before, &before);

  EXPECT_GT(now.involuntarySwitches, start.involuntarySwitches);
  EXPECT_EQ(disturbanceBetween(start, now, 1e9).substr(0, 8), "switches");
}

TEST(Disturbance, namesItsReasons) {
  const DisturbanceCounters quiet{.involuntarySwitches = 5, .pressureUs = 1000, .stealTicks = 7};
  EXPECT_EQ(disturbanceBetween(quiet, quiet, 10), "");
  auto later = quiet;
  later.involuntarySwitches += 1;
  EXPECT_EQ(disturbanceBetween(quiet, later, 10), "switches");
  later.stealTicks += 1;
  EXPECT_EQ(disturbanceBetween(quiet, later, 10), "switches+steal");
  later.pressureUs += 10000;
  EXPECT_EQ(disturbanceBetween(quiet, later, 10), "switches+pressure+steal");
}

// 5 % of 10 ms are 500 us: that much is still quiet.
TEST(Disturbance, pressureCountsOverFivePercentOfTheFrame) {
  const DisturbanceCounters quiet;
  EXPECT_EQ(disturbanceBetween(quiet, {.pressureUs = 500}, 10), "");
  EXPECT_EQ(disturbanceBetween(quiet, {.pressureUs = 501}, 10), "pressure");
  EXPECT_EQ(disturbanceBetween(quiet, {.pressureUs = 501}, 20), "");
}

} // namespace
} // namespace volmark
