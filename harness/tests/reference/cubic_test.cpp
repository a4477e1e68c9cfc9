#include "reference/cubic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace volmark::reference {

namespace {

/// The cubic with the given roots and sign, in Bernstein form.
Cubic withRoots(double r0, double r1, double r2, double scale) {
  // The polar form of (s-r0)(s-r1)(s-r2), symmetrised over the roots, at (0,0,0), (0,0,1), (0,1,1), (1,1,1).
  const double a0 = -r0 * r1 * r2;
  const double a1 = r0 * r1 + r0 * r2 + r1 * r2;
  const double a2 = -(r0 + r1 + r2);
  return {{scale * a0, scale * (a0 + a1 / 3), scale * (a0 + 2 * a1 / 3 + a2 / 3), scale * (a0 + a1 + a2 + 1)}};
}

} // namespace

TEST(Cubic, IsTheTrilinearFieldOnTheLine) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 200; ++i) {
    Corners corners;
    for (double& corner : corners)
      corner = uniform(random);
    const glm::dvec3 from(uniform(random), uniform(random), uniform(random));
    const glm::dvec3 to(uniform(random), uniform(random), uniform(random));
    const Cubic cubic = cubicAlong(corners, from, to, 0.25);
    for (double s : {0.0, 0.2, 0.5, 0.9, 1.0}) {
      const double field = trilinear(corners, from + s * (to - from)) - 0.25;
      EXPECT_NEAR(cubic(s), field, 1e-14);
      EXPECT_LE(cubic.lowerBound(), field + 1e-14);
      EXPECT_GE(cubic.upperBound(), field - 1e-14);
    }
  }
}

TEST(Cubic, CornersAreNumberedXFirst) {
  Corners corners{};
  corners[1] = 1;
  EXPECT_DOUBLE_EQ(trilinear(corners, {1, 0, 0}), 1);
  corners = {};
  corners[2] = 1;
  EXPECT_DOUBLE_EQ(trilinear(corners, {0, 1, 0}), 1);
  corners = {};
  corners[4] = 1;
  EXPECT_DOUBLE_EQ(trilinear(corners, {0.5, 0.5, 0.5}), 0.125);
}

TEST(Cubic, FindsTheFirstOfThreeRoots) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0.01, 0.99);
  for (int i = 0; i < 1000; ++i) {
    std::array<double, 3> roots = {uniform(random), uniform(random), uniform(random)};
    std::sort(roots.begin(), roots.end());
    if (roots[1] - roots[0] < 1e-3 || roots[2] - roots[1] < 1e-3) continue;
    const auto found = firstNonNegative(withRoots(roots[0], roots[1], roots[2], 1));
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found, roots[0], 1e-10);
  }
}

TEST(Cubic, FindsAPairOfCloseRoots) {
  // Both ends are negative: only the extremum in between tells.
  const auto found = firstNonNegative(withRoots(0.5, 0.5001, 2, 1));
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 0.5, 1e-9);
  EXPECT_FALSE(firstNonNegative(withRoots(1.2, 1.5, 2, 1)));
}

TEST(Cubic, LinearAndConstantFieldsAreCubicsToo) {
  EXPECT_DOUBLE_EQ(*firstNonNegative({{-1, -1 + 4 / 3.0, -1 + 8 / 3.0, 3}}), 0.25);
  EXPECT_EQ(firstNonNegative({{-1, -1, -1, -1}}), std::nullopt);
  EXPECT_EQ(*firstNonNegative({{0, 0, 0, 0}}), 0);
  EXPECT_EQ(*firstNonNegative({{-1, -1, -1, 0}}), 1);
}

TEST(Cubic, ResultIsInsideAndItsNeighbourIsNot) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const Cubic cubic{{-0.5 + 0.5 * uniform(random), 2 * uniform(random), 2 * uniform(random), uniform(random)}};
    const auto found = firstNonNegative(cubic);
    // A scan sees no crossing before the one found.
    for (int k = 0; k <= 256; ++k)
      if (!found || k / 256.0 < *found) {
        EXPECT_LT(cubic(k / 256.0), 1e-15) << i;
      }
    if (found) {
      EXPECT_GE(cubic(*found), 0);
    }
  }
}

} // namespace volmark::reference
