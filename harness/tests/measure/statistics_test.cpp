#include "measure/statistics.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <random>
#include <string>
#include <unistd.h>

namespace volmark {
namespace {

std::vector<double> randomTimes(int count, unsigned seed) {
  std::mt19937 engine(seed);
  std::lognormal_distribution<double> distribution(1.5, 0.6);
  std::vector<double> times(static_cast<std::size_t>(count));
  for (double& time : times)
    time = distribution(engine);
  return times;
}

std::array<double, 9> valuesOf(const Statistics& s) {
  return {s.meanMs, s.medianMs, s.p99Ms, s.low1AvgMs, s.low1IntegralMs, s.fps, s.clockMeanMs, s.minMs, s.maxMs};
}

TEST(Statistics, handCaseOfFour) {
  const std::vector<double> times{4, 1, 2, 5};
  const Statistics s = statisticsOf(times);
  EXPECT_EQ(s.count, 4);
  EXPECT_DOUBLE_EQ(s.meanMs, 3);
  EXPECT_DOUBLE_EQ(s.medianMs, 3);
  EXPECT_DOUBLE_EQ(s.p99Ms, 4 + 0.97); // place 2.97 between 4 and 5
  EXPECT_DOUBLE_EQ(s.low1AvgMs, 5);
  EXPECT_DOUBLE_EQ(s.low1IntegralMs, 5);
  EXPECT_DOUBLE_EQ(s.fps, 1000.0 / 3);
  EXPECT_DOUBLE_EQ(s.clockMeanMs, 4 / (0.25 + 1 + 0.5 + 0.2));
  EXPECT_DOUBLE_EQ(s.minMs, 1);
  EXPECT_DOUBLE_EQ(s.maxMs, 5);
}

TEST(Statistics, oneFrameIsEveryStatistic) {
  const std::vector<double> times{7.25};
  const Statistics s = statisticsOf(times);
  EXPECT_EQ(s.count, 1);
  EXPECT_THAT(valuesOf(s),
              testing::ElementsAre(7.25, 7.25, 7.25, 7.25, 7.25, 1000 / 7.25, testing::DoubleEq(7.25), 7.25, 7.25));
}

// The slowest ceil(n/100): one frame up to 100, two from 101, three from 201.
TEST(Statistics, low1AverageTakesOneFrameInAHundredRoundedUp) {
  for (const auto& [count, slowest] : {std::pair{99, 1}, {100, 1}, {101, 2}, {200, 2}, {201, 3}, {299, 3}, {300, 3}}) {
    std::vector<double> times(static_cast<std::size_t>(count));
    std::iota(times.begin(), times.end(), 1.0);
    double sum = 0;
    for (int i = 0; i < slowest; ++i)
      sum += count - i;
    EXPECT_DOUBLE_EQ(statisticsOf(times).low1AvgMs, sum / slowest) << count;
  }
}

TEST(Statistics, low1IntegralOfKnownTimes) {
  // 1 % of 2000 ms is 20 ms: the two slowest cover 18 ms, the third one is needed.
  std::vector<double> times(1979, 1.0);
  times.insert(times.end(), {10, 8, 3});
  EXPECT_DOUBLE_EQ(statisticsOf(times).low1IntegralMs, 3);
  // One long hitch covers 1 % alone.
  times.push_back(500);
  EXPECT_DOUBLE_EQ(statisticsOf(times).low1IntegralMs, 500);
}

// The definition: frames slower than the result cover less than 1 % of the time, with it they cover 1 %.
TEST(Statistics, low1IntegralCoversOnePercentOfTheTime) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const auto times = randomTimes(1 + static_cast<int>(seed * 7), seed);
    const double result = statisticsOf(times).low1IntegralMs;
    double total = 0, slower = 0, atLeast = 0;
    for (double time : times) {
      total += time;
      if (time > result) slower += time;
      if (time >= result) atLeast += time;
    }
    EXPECT_LT(slower, 0.01 * total);
    EXPECT_GE(atLeast, 0.01 * total * (1 - 1e-12));
    EXPECT_THAT(times, testing::Contains(result));
  }
}

TEST(Statistics, orderDoesNotMatter) {
  std::mt19937 engine(3);
  for (int count : {1, 2, 3, 100, 101, 299, 300, 1000}) {
    auto times = randomTimes(count, static_cast<unsigned>(count));
    const auto expected = valuesOf(statisticsOf(times));
    for (int i = 0; i < 10; ++i) {
      std::shuffle(times.begin(), times.end(), engine);
      EXPECT_EQ(valuesOf(statisticsOf(times)), expected) << count;
    }
  }
}

TEST(Statistics, scaleWithTheTimes) {
  for (int count : {1, 7, 100, 101, 299}) {
    const auto times = randomTimes(count, 11);
    for (double factor : {1e-3, 0.37, 2.0, 1e4}) {
      auto scaled = times;
      for (double& time : scaled)
        time *= factor;
      auto expected = valuesOf(statisticsOf(times));
      const auto found = valuesOf(statisticsOf(scaled));
      for (std::size_t i = 0; i < expected.size(); ++i) {
        const double wanted = i == 5 ? expected[i] / factor : expected[i] * factor; // 5: fps
        EXPECT_NEAR(found[i], wanted, 1e-12 * std::abs(wanted)) << i;
      }
    }
  }
}

TEST(Statistics, areOrdered) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const Statistics s = statisticsOf(randomTimes(1 + static_cast<int>(seed) * 5, seed));
    EXPECT_LE(s.minMs, s.clockMeanMs * (1 + 1e-12));
    EXPECT_LE(s.clockMeanMs, s.meanMs * (1 + 1e-12)); // harmonic mean under arithmetic mean
    EXPECT_LE(s.medianMs, s.p99Ms);
    EXPECT_LE(s.p99Ms, s.maxMs);
    EXPECT_LE(s.low1AvgMs, s.maxMs * (1 + 1e-12));
    EXPECT_LE(s.low1IntegralMs, s.maxMs);
    EXPECT_GE(s.low1AvgMs, s.meanMs * (1 - 1e-12));
  }
}

TEST(Statistics, acceptTimesOfNoWork) {
  const Statistics some = statisticsOf(std::vector<double>{0, 0, 3});
  EXPECT_EQ(some.meanMs, 1);
  EXPECT_EQ(some.clockMeanMs, 0);
  const Statistics none = statisticsOf(std::vector<double>{0, 0});
  EXPECT_EQ(none.meanMs, 0);
  EXPECT_TRUE(std::isinf(none.fps));
  EXPECT_EQ(none.low1IntegralMs, 0);
}

// The same numbers from numpy, written independently of the code above.
constexpr const char* kNumpy = R"(
import sys
import numpy as np
for line in open(sys.argv[1]):
    t = np.array([float.fromhex(x) for x in line.split()])
    slow = np.sort(t)[::-1]
    low1 = slow[:int(np.ceil(len(t) / 100))].mean()
    integral = slow[np.searchsorted(np.cumsum(slow), 0.01 * t.sum())]
    values = [t.mean(), np.median(t), np.percentile(t, 99), low1, integral, 1000 / t.mean(), 1 / (1 / t).mean(),
              t.min(), t.max()]
    print(' '.join(float(v).hex() for v in values))
)";

TEST(Statistics, agreeWithNumpy) {
  if (std::system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0) GTEST_SKIP() << "no numpy";
  const std::string folder = testing::TempDir();
  const std::string script = fmt::format("{}/volmark_numpy_{}.py", folder, getpid());
  const std::string input = fmt::format("{}/volmark_times_{}.txt", folder, getpid());
  std::vector<std::vector<double>> cases;
  for (int count : {1, 2, 3, 10, 99, 100, 101, 199, 200, 201, 299, 300, 1000, 5000})
    for (unsigned seed = 0; seed < 5; ++seed)
      cases.push_back(randomTimes(count, seed + static_cast<unsigned>(count)));

  std::FILE* file = std::fopen(script.c_str(), "w");
  ASSERT_NE(file, nullptr);
  std::fputs(kNumpy, file);
  std::fclose(file);
  file = std::fopen(input.c_str(), "w");
  ASSERT_NE(file, nullptr);
  for (const auto& times : cases) {
    for (double time : times)
      std::fprintf(file, "%a ", time);
    std::fputc('\n', file);
  }
  std::fclose(file);

  std::FILE* output = popen(fmt::format("/usr/bin/python3 '{}' '{}'", script, input).c_str(), "r");
  ASSERT_NE(output, nullptr);
  for (const auto& times : cases) {
    for (double found : valuesOf(statisticsOf(times))) {
      double expected = 0;
      ASSERT_EQ(std::fscanf(output, "%la", &expected), 1);
      EXPECT_NEAR(found, expected, 1e-12 * expected) << times.size();
    }
  }
  EXPECT_EQ(pclose(output), 0);
  unlink(script.c_str());
  unlink(input.c_str());
}

} // namespace
} // namespace volmark
