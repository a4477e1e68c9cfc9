// Mathematics of generators: functions whose results are the same bits on every machine. The C library's sine, cosine,
// exponential and power are not: they choose instructions by the processor they find. Only +, -, *, /, square roots,
// floor and scaling by powers of two are used here, all of them exactly rounded.
#pragma once

#include "volmark/random.h"

#include <glm/glm.hpp>

#include <cstdint>

namespace volmark {

/// Sine and cosine of `t` quarter turns, |t| < 1e9, to about 1e-16.
double sineOfQuarterTurns(double t);
double cosineOfQuarterTurns(double t);

/// x^y for x > 0 and |y log2(x)| < 1000, to a relative error of about 1e-15 where |y log2(x)| < 10.
double power(double x, double y);

/// From 0 to 1 over [0,1] with zero first and second derivatives at both ends; constant outside.
double smoothStep(double t);
double smoothStepSlope(double t);

/// Uniform in [0,1): number `index` of an item, all of them independent.
inline double randomUnit(std::uint32_t seed, std::uint32_t item, std::uint32_t index) {
  return double(toUnitFloat(randomBits(seed, item, 0, index)));
}

} // namespace volmark
