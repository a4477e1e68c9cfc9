#include "reference/medium.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace volmark::reference {

namespace {

/// Random control points, some of them jumps, some above the cap of opacity.
TransferFunction randomFunction(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<ControlPoint> points(static_cast<std::size_t>(2 + 6 * uniform(random)));
  for (ControlPoint& point : points) {
    point.value = std::round(12 * uniform(random)) / 12;
    point.color = {uniform(random), uniform(random), uniform(random)};
    point.opacity = std::max(0.0, 1.4 * uniform(random) - 0.4);
  }
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  return {"random", points};
}

/// Midpoint quadrature of the emission-absorption integral.
glm::dvec4 bruteForce(const TransferFunction& function, double front, double back, double length) {
  constexpr int kParts = 100000;
  glm::dvec3 color(0);
  double depth = 0;
  for (int i = 0; i < kParts; ++i) {
    const glm::dvec4 at = function.evaluate(front + (back - front) * (i + 0.5) / kParts);
    const double part = -std::log1p(-at.a) * length / kParts;
    color += glm::dvec3(at) * std::exp(-depth - 0.5 * part) * part;
    depth += part;
  }
  return glm::dvec4(color, -std::expm1(-depth));
}

double largest(const glm::dvec4& v) {
  return std::max({std::abs(v.r), std::abs(v.g), std::abs(v.b), std::abs(v.a)});
}

} // namespace

TEST(Medium, IsTheTransferFunction) {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const TransferFunction function = randomFunction(random);
    const Medium medium(function);
    for (int k = 0; k <= 240; ++k) {
      // Every tenth value lies on control points, where jumps must choose the later point.
      const double value = k % 20 == 0 ? (k / 20) / 12.0 : k / 240.0;
      EXPECT_LT(largest(medium.evaluate(value) - function.evaluate(value)), 1e-12);
    }
    EXPECT_EQ(medium.evaluate(-3), medium.evaluate(0));
    EXPECT_EQ(medium.evaluate(7), medium.evaluate(1));
  }
}

TEST(Medium, PointsOutsideTheRangeAreClampedAway) {
  const Medium medium({"wide", {{-1, {0, 0, 0}, 0}, {3, {1, 1, 1}, 0.8}}});
  EXPECT_NEAR(medium.evaluate(0.5).a, 0.3, 1e-15);
  EXPECT_NEAR(medium.evaluate(2).a, 0.4, 1e-15);
  EXPECT_NEAR(medium.evaluate(-0.5).a, 0.2, 1e-15);
}

TEST(Medium, SlabsAgreeWithBruteForce) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 60; ++i) {
    const TransferFunction function = randomFunction(random);
    const double front = uniform(random);
    const double back = i % 7 == 0 ? front : uniform(random);
    const double length = i % 2 ? 4 * uniform(random) : 0.5 * uniform(random);
    const glm::dvec4 found = Medium(function).slab(front, back, length);
    // The quadrature's error at jumps is about one part in a hundred thousand of the slab.
    EXPECT_LT(largest(found - bruteForce(function, front, back, length)), 2e-4) << i;
  }
}

TEST(Medium, SlabsOfASmoothFunctionAreExact) {
  // No jumps: the quadrature is good to 1e-7.
  const TransferFunction function("ramp", {{0, {0, 1, 0.2}, 0.1}, {1, {1, 0, 0.4}, 0.8}});
  for (const double length : {0.01, 1.0, 3.0, 12.0})
    for (const auto& [front, back] : {std::pair(0.0, 1.0), std::pair(0.9, 0.3), std::pair(0.5, 0.5001)})
      EXPECT_LT(largest(Medium(function).slab(front, back, length) - bruteForce(function, front, back, length)), 1e-7);
}

// A slab is the same as two that share its length where the scalar is divided in the same ratio.
TEST(Medium, SlabsCompose) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 200; ++i) {
    const Medium medium(randomFunction(random));
    const double front = uniform(random) * 1.4 - 0.2;
    const double back = uniform(random) * 1.4 - 0.2;
    const double share = uniform(random);
    const glm::dvec4 whole = medium.slab(front, back, 2);
    const double middle = front + share * (back - front);
    const glm::dvec4 first = medium.slab(front, middle, 2 * share);
    const glm::dvec4 second = medium.slab(middle, back, 2 * (1 - share));
    EXPECT_LT(largest(whole - (first + (1 - first.a) * second)), 1e-6) << i;
    EXPECT_GE(whole.a, 0);
    EXPECT_LE(whole.a, 1);
    for (int c = 0; c < 3; ++c)
      EXPECT_LE(whole[c], whole.a + 1e-12);
  }
}

TEST(Medium, TransparencyIsNeverClaimedWrongly) {
  const Medium medium({"two windows", {{0.2, {}, 0}, {0.3, {}, 0.5}, {0.4, {}, 0}, {0.6, {}, 0}, {0.6, {}, 1}}});
  EXPECT_TRUE(medium.isTransparent(-1, 0.2));
  EXPECT_TRUE(medium.isTransparent(0.4, 0.5999));
  EXPECT_FALSE(medium.isTransparent(0.1, 0.21));
  EXPECT_FALSE(medium.isTransparent(0.1, 0.5));
  EXPECT_FALSE(medium.isTransparent(0.5, 0.6));
  EXPECT_FALSE(medium.isTransparent(2, 3));
}

} // namespace volmark::reference
