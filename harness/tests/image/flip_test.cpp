#include "image/flip.h"

#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace volmark {

namespace {

constexpr int kWidth = 48;
constexpr int kHeight = 36;

Planes uniform(const glm::dvec3& color) {
  Planes planes = makePlanes(kWidth, kHeight);
  for (int channel = 0; channel < 3; ++channel)
    std::fill(planes[channel].values.begin(), planes[channel].values.end(), color[channel]);
  return planes;
}

/// Blocks of 4 x 4 pixels of random colours in [0, scale].
Planes blocks(unsigned seed, double scale = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(0, scale);
  Planes planes = makePlanes(kWidth, kHeight);
  for (Plane& plane : planes)
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        plane.row(y)[x] = x % 4 == 0 && y % 4 == 0 ? value(random) : plane.row(y - y % 4)[x - x % 4];
  return planes;
}

Planes scaled(Planes planes, double factor) {
  for (Plane& plane : planes)
    for (double& value : plane.values)
      value *= factor;
  return planes;
}

double mean(const Plane& map) {
  double sum = 0;
  for (const double value : map.values)
    sum += value;
  return sum / static_cast<double>(map.values.size());
}

void expectAll(const Plane& map, double expected, double tolerance) {
  for (const double value : map.values)
    ASSERT_NEAR(value, expected, tolerance);
}

} // namespace

TEST(Flip, EqualPicturesDoNotDiffer) {
  expectAll(flipMap(blocks(1), blocks(1)), 0, 0);
  expectAll(hdrFlipMap(blocks(1, 10), blocks(1, 10)), 0, 0);
}

// HyAB is 100 for black and white and 203.3017 for green and blue: the share (100 / 203.3017)^0.7 = 0.608557 lies
// above the knee, at 0.95 + 0.05 (0.608557 - 0.4) / 0.6.
TEST(Flip, BlackAgainstWhiteHasAClosedForm) {
  expectAll(flipMap(uniform({0, 0, 0}), uniform({1, 1, 1})), 0.96737976, 1e-7);
}

// The two colours that are farthest apart.
TEST(Flip, GreenAgainstBlueIsOne) {
  expectAll(flipMap(uniform({0, 1, 0}), uniform({0, 0, 1})), 1, 1e-9);
}

TEST(Flip, LdrIsSymmetricAndInRange) {
  const Plane there = flipMap(blocks(1), blocks(2));
  const Plane back = flipMap(blocks(2), blocks(1));
  for (std::size_t i = 0; i < there.values.size(); ++i) {
    ASSERT_DOUBLE_EQ(there.values[i], back.values[i]);
    ASSERT_GE(there.values[i], 0);
    ASSERT_LE(there.values[i], 1);
  }
}

TEST(Flip, GrowsWithNoise) {
  const Planes clean = uniform({0.3, 0.5, 0.2});
  const Planes grain = blocks(3);
  double before = 0;
  for (const double strength : {0.01, 0.03, 0.1, 0.3}) {
    Planes noisy = clean;
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < noisy[c].values.size(); ++i)
        noisy[c].values[i] = std::clamp(noisy[c].values[i] + strength * (grain[c].values[i] - 0.5), 0.0, 1.0);
    const double error = mean(flipMap(noisy, clean));
    EXPECT_GT(error, before);
    before = error;
  }
}

// Seen from farther away, fine patterns blur into their mean, and into an error that is smaller.
TEST(Flip, FinePatternsFadeWithDistance) {
  Planes checkers = uniform({0.2, 0.2, 0.2});
  for (Plane& plane : checkers)
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        if ((x + y) % 2 == 0) plane.row(y)[x] = 0.4;
  const Planes flat = uniform({0.3, 0.3, 0.3});
  EXPECT_LT(mean(flipMap(checkers, flat, 67)), 0.5 * mean(flipMap(checkers, flat, 10)));
}

// A grey line one pixel wide. Its colour is blurred as far as contrast sensitivity says (grey stays grey, so only the
// achromatic filter matters); in its middle it is a point feature, and no edge.
TEST(Flip, LinesHaveAClosedForm) {
  Planes line = uniform({0.5, 0.5, 0.5});
  for (Plane& plane : line)
    for (int y = 0; y < kHeight; ++y)
      plane.row(y)[kWidth / 2] = 0.8;
  const Plane map = flipMap(line, uniform({0.5, 0.5, 0.5}));

  const double pi = std::acos(-1.0);
  double total = 0;
  double negative = 0;
  for (int i = -10; i <= 10; ++i) {
    const double degrees = i / kPixelsPerDegree;
    total += std::exp(-pi * pi * degrees * degrees / 0.0047);
    const double share = i / (0.5 * 0.082 * kPixelsPerDegree);
    if (std::abs(share) < 1) negative += std::exp(-share * share / 2) * (1 - share * share);
  }
  const double blurred = 0.5 + 0.3 / total;
  const double color = flipMap(uniform({blurred, blurred, blurred}), uniform({0.5, 0.5, 0.5})).values[0];
  const double feature = std::sqrt(0.3 / negative / std::sqrt(2.0));
  EXPECT_NEAR(map.row(kHeight / 2)[kWidth / 2], std::pow(color, 1 - feature), 1e-5);
  // Far away nothing has changed.
  EXPECT_EQ(map.row(kHeight / 2)[1], 0);
}

TEST(Flip, ExposuresGoFromTheBrightestToTheMedian) {
  // 60 % of the pixels are 0.25, the rest 4: four stops apart.
  Planes picture = uniform({0.25, 0.25, 0.25});
  for (Plane& plane : picture)
    std::fill(plane.values.begin() + static_cast<int>(0.6 * kWidth * kHeight), plane.values.end(), 4.0);
  const std::vector<double> exposures = flipExposures(picture);
  ASSERT_EQ(exposures.size(), 4u);
  EXPECT_NEAR(exposures.back() - exposures.front(), 4, 1e-9);
  // There the curve of the brightest pixel is 0.85.
  const double x = 0.6 * 4 * std::exp2(exposures.front());
  EXPECT_NEAR(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.85, 1e-9);
  EXPECT_NEAR(exposures[1] - exposures[0], 4.0 / 3, 1e-9);
}

TEST(Flip, ExposuresAreFiniteForEveryReference) {
  EXPECT_EQ(flipExposures(uniform({0, 0, 0})), std::vector<double>{0});
  EXPECT_EQ(flipExposures(uniform({-1, 0, -2})), std::vector<double>{0});
  EXPECT_EQ(flipExposures(uniform({HUGE_VAL, 0, 0})), std::vector<double>{0});
  EXPECT_EQ(flipExposures(uniform({1, 2, 3})).size(), 2u);
  // More than half black: the median of the others.
  Planes mostlyBlack = uniform({0, 0, 0});
  for (Plane& plane : mostlyBlack)
    for (int i = 0; i < 5; ++i)
      plane.values[static_cast<std::size_t>(i)] = i == 0 ? 8 : 2;
  const std::vector<double> exposures = flipExposures(mostlyBlack);
  EXPECT_NEAR(exposures.back() - exposures.front(), 2, 1e-9);
}

// What the camera's gain is doesn't matter: the exposures follow the reference.
TEST(Flip, HdrDoesNotDependOnTheScale) {
  const Plane one = hdrFlipMap(blocks(1, 3), blocks(2, 3));
  const Plane sixteen = hdrFlipMap(scaled(blocks(1, 3), 16), scaled(blocks(2, 3), 16));
  for (std::size_t i = 0; i < one.values.size(); ++i)
    ASSERT_NEAR(one.values[i], sixteen.values[i], 1e-9);
}

// Clamped both pictures are white; at a shorter exposure one is not.
TEST(Flip, HdrSeesWhatClampingHides) {
  Planes bright = uniform({2, 2, 2});
  for (Plane& plane : bright)
    std::fill_n(plane.values.begin(), kWidth * kHeight / 4, 8.0);
  Planes dimmer = bright;
  for (Plane& plane : dimmer)
    std::fill_n(plane.values.begin(), kWidth * kHeight / 4, 4.0);
  EXPECT_GT(mean(hdrFlipMap(dimmer, bright)), 0.01);
}

} // namespace volmark
