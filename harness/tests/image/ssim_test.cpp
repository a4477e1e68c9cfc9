#include "image/ssim.h"

#include <gtest/gtest.h>

#include <random>

namespace volmark {

namespace {

Plane noise(unsigned seed, int width = 40, int height = 30) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(0, 1);
  Plane plane(width, height);
  for (double& v : plane.values)
    v = value(random);
  return plane;
}

Plane constant(double value) {
  Plane plane(20, 15);
  std::fill(plane.values.begin(), plane.values.end(), value);
  return plane;
}

double similarity(const Plane& a, const Plane& b) {
  return meanSsim(ssimMap(a, b)).value();
}

} // namespace

TEST(Ssim, EqualPlanesAreExactlyAlike) {
  EXPECT_EQ(similarity(noise(1), noise(1)), 1);
  EXPECT_EQ(similarity(constant(0.3), constant(0.3)), 1);
}

// Without variance the luminance term is left: (2ab + C1) / (a^2 + b^2 + C1).
TEST(Ssim, ConstantsHaveAClosedForm) {
  EXPECT_NEAR(similarity(constant(0), constant(1)), 1e-4 / 1.0001, 1e-12);
  EXPECT_NEAR(similarity(constant(0.5), constant(0.25)), 0.2501 / 0.3126, 1e-12);
}

// Mirrored about its mean a pattern has the same moments and the opposite covariance.
TEST(Ssim, OppositePatternsAreNegative) {
  const Plane a = noise(1);
  Plane b = a;
  for (double& value : b.values)
    value = 1 - value;
  EXPECT_LT(similarity(a, b), -0.5);
}

TEST(Ssim, IsSymmetricAndFallsWithNoise) {
  const Plane clean = constant(0.5);
  const Plane grain = noise(2, 20, 15);
  double before = 1;
  for (const double strength : {0.02, 0.05, 0.1, 0.3}) {
    Plane noisy = clean;
    for (std::size_t i = 0; i < noisy.values.size(); ++i)
      noisy.values[i] += strength * (grain.values[i] - 0.5);
    EXPECT_DOUBLE_EQ(similarity(clean, noisy), similarity(noisy, clean));
    EXPECT_LT(similarity(clean, noisy), before);
    before = similarity(clean, noisy);
  }
}

// The definition, window by window, without separating the Gaussian.
TEST(Ssim, EqualsTheSumOverAWindow) {
  const Plane a = noise(3);
  const Plane b = noise(4);
  double total = 0, meanA = 0, meanB = 0, squareA = 0, squareB = 0, products = 0;
  for (int y = -5; y <= 5; ++y)
    for (int x = -5; x <= 5; ++x) {
      const double weight = std::exp(-(x * x + y * y) / 4.5);
      const double va = a.row(12 + y)[17 + x];
      const double vb = b.row(12 + y)[17 + x];
      total += weight;
      meanA += weight * va;
      meanB += weight * vb;
      squareA += weight * va * va;
      squareB += weight * vb * vb;
      products += weight * va * vb;
    }
  meanA /= total;
  meanB /= total;
  const double varianceA = squareA / total - meanA * meanA;
  const double varianceB = squareB / total - meanB * meanB;
  const double covariance = products / total - meanA * meanB;
  const double expected = (2 * meanA * meanB + 1e-4) * (2 * covariance + 9e-4) /
                          ((meanA * meanA + meanB * meanB + 1e-4) * (varianceA + varianceB + 9e-4));
  EXPECT_NEAR(ssimMap(a, b).row(12)[17], expected, 1e-12);
}

TEST(Ssim, CountsWholeWindowsOnly) {
  const Plane a = noise(5);
  Plane map = ssimMap(a, a);
  // The outer five rows and columns don't count, the sixth does.
  for (int x = 0; x < map.width; ++x)
    map.row(4)[x] = 0;
  for (int y = 0; y < map.height; ++y)
    map.row(y)[4] = 0;
  EXPECT_EQ(meanSsim(map).value(), 1);
  map.row(5)[5] = 0;
  EXPECT_NEAR(meanSsim(map).value(), 1 - 1.0 / (30 * 20), 1e-12);
}

TEST(Ssim, IsAbsentWhereNoWindowFits) {
  EXPECT_FALSE(meanSsim(ssimMap(noise(1, 10, 40), noise(2, 10, 40))));
  EXPECT_FALSE(meanSsim(ssimMap(noise(1, 40, 10), noise(2, 40, 10))));
  EXPECT_TRUE(meanSsim(ssimMap(noise(1, 11, 11), noise(2, 11, 11))));
}

} // namespace volmark
