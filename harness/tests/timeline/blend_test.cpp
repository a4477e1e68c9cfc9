// A blend of two transfer functions is, at every scalar, the mix of what they say there.
#include "volmark/transfer_function.h"

#include <gtest/gtest.h>

#include <cmath>

namespace volmark {
namespace {

double largest(const glm::dvec4& v) {
  return std::max({std::abs(v.r), std::abs(v.g), std::abs(v.b), std::abs(v.a)});
}

/// Two jumps, one of them at a scalar where `ramp` bends.
TransferFunction steps() {
  return {
      "steps",
      {{0.2, {1, 0, 0}, 0}, {0.4, {1, 0, 0}, 0}, {0.4, {0, 1, 0}, 0.6}, {0.7, {0, 1, 1}, 0.2}, {0.7, {0, 0, 0}, 0.9}}};
}

TransferFunction ramp() {
  return {"ramp", {{0.1, {0, 0, 1}, 0.1}, {0.4, {1, 1, 1}, 0.3}, {0.9, {0.5, 0, 0}, 0.8}}};
}

TEST(TransferFunctionBlend, MixesTheTwoAtEveryScalar) {
  for (const double share : {0.0, 0.25, 0.5, 1.0}) {
    const TransferFunction both = TransferFunction::blend(steps(), ramp(), share);
    for (int i = 0; i <= 1000; ++i) {
      const double value = (i + 0.5) / 1001; // never at a jump
      const glm::dvec4 expected = glm::mix(steps().evaluate(value), ramp().evaluate(value), share);
      EXPECT_LT(largest(both.evaluate(value) - expected), 1e-12) << value << ", share " << share;
    }
  }
}

TEST(TransferFunctionBlend, KeepsJumpsAsJumps) {
  const TransferFunction both = TransferFunction::blend(steps(), ramp(), 0.5);
  for (const double jump : {0.4, 0.7}) {
    const glm::dvec4 below = both.evaluate(jump - 1e-9);
    const glm::dvec4 above = both.evaluate(jump + 1e-9);
    const glm::dvec4 mixed = 0.5 * (steps().evaluate(jump + 1e-9) - steps().evaluate(jump - 1e-9));
    EXPECT_GT(std::abs(above.a - below.a), 0.2);
    EXPECT_NEAR(above.a - below.a, mixed.a, 1e-6);
  }
  // The ends of either function hold beyond them.
  EXPECT_NEAR(both.evaluate(0).a, 0.5 * 0 + 0.5 * 0.1, 1e-12);
  EXPECT_NEAR(both.evaluate(1).a, 0.5 * 0.9 + 0.5 * 0.8, 1e-12);
}

} // namespace
} // namespace volmark
