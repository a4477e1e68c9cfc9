#include "volume/generators/blast_wave.h"
#include "volume/generators/portable_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace volmark::test {
namespace {

/// Where the density falls through the middle between front and air, seen from outside.
double outermostCrossing(const Field& field, const glm::dvec3& direction) {
  const double middle = (1 + BlastWave::kAir) / 2;
  for (double r = 1; r > 0; r -= 0.0005)
    if (field.value(r * direction) >= middle) return r;
  return 0;
}

glm::dvec3 direction(std::uint32_t i) {
  const double z = 2 * randomUnit(1, i, 0) - 1;
  const double angle = 2 * 3.14159265 * randomUnit(1, i, 1);
  return {std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z};
}

TEST(BlastWave, FrontGrowsAsTimeToTwoFifths) {
  const BlastWaveSettings settings{.timeSteps = 30, .instability = 0, .frontWidth = 0.001};
  for (int step = 0; step < 30; ++step) {
    const BlastWave field(settings, step);
    const double expected = BlastWave::kLastRadius * std::pow((step + 1) / 30.0, 0.4);
    EXPECT_NEAR(field.frontRadius(), expected, 1e-14);
    for (std::uint32_t i = 0; i < 20; ++i)
      EXPECT_NEAR(outermostCrossing(field, direction(i)), expected, 0.002) << step;
  }
}

TEST(BlastWave, FrontGrowsInEveryDirection) {
  for (std::uint32_t i = 0; i < 100; ++i) {
    double last = 0;
    for (int step = 0; step < 30; ++step) {
      const double front = outermostCrossing(BlastWave({}, step), direction(i));
      EXPECT_GT(front, last) << "direction " << i << " step " << step;
      last = front;
    }
    EXPECT_LT(last, 1);
  }
}

TEST(BlastWave, WrinklesGrow) {
  const auto spread = [](int step) {
    const BlastWave field({}, step);
    double least = 1e9;
    double most = 0;
    for (std::uint32_t i = 0; i < 300; ++i) {
      const double front = outermostCrossing(field, direction(i)) / field.frontRadius();
      least = std::min(least, front);
      most = std::max(most, front);
    }
    return most - least;
  };
  EXPECT_GT(spread(29), 0.15);
  EXPECT_GT(spread(29), 1.5 * spread(2));
}

/// The gas inside of the front is what was there before.
TEST(BlastWave, HoldsTheMassSweptUp) {
  const BlastWave field({.instability = 0}, 20);
  const double radius = field.frontRadius();
  constexpr int count = 100000;
  double mass = 0;
  for (int i = 0; i < count; ++i) {
    const double r = radius * (i + 0.5) / count;
    mass += field.value({r, 0, 0}) * 3 * r * r / std::pow(radius, 3) * radius / count;
  }
  EXPECT_NEAR(mass, BlastWave::kAir, 1e-6);
}

TEST(BlastWave, EachStepIsAnother) {
  std::set<std::string> identities;
  for (int step = 0; step < 30; ++step) {
    const BlastWave field({}, step);
    std::string bytes;
    for (double x = -1; x <= 1; x += 0.1)
      bytes += std::to_string(field.value({x, 0.1, 0.2})) + " ";
    identities.insert(bytes);
  }
  EXPECT_EQ(identities.size(), 30u);
}

} // namespace
} // namespace volmark::test
