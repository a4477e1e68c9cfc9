#include "volume/generators/fields.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace volmark {

namespace {

/// Taylor series sum of terms (-x^2)^i / (first (first+1) ... (first+2i-1)...), by Horner's rule from the last term.
/// `first`: 1 for sin(x)/x, 0 for cos(x). |x| <= pi/4: the terms left out are below 1e-19.
double series(double squared, int first) {
  double sum = 1;
  for (int n = first + 18; n > first; n -= 2)
    sum = 1 - squared / (double(n) * (n - 1)) * sum;
  return sum;
}

/// Of t quarter turns, |t| <= 1/2.
double smallSine(double t) {
  const double x = t * (std::numbers::pi / 2);
  return x * series(x * x, 1);
}
double smallCosine(double t) {
  const double x = t * (std::numbers::pi / 2);
  return series(x * x, 0);
}

} // namespace

double sineOfQuarterTurns(double t) {
  // Taking off whole quarter turns is exact.
  const double whole = std::floor(t + 0.5);
  const double rest = t - whole;
  switch (static_cast<std::int64_t>(whole) & 3) {
  case 0: return smallSine(rest);
  case 1: return smallCosine(rest);
  case 2: return -smallSine(rest);
  default: return -smallCosine(rest);
  }
}

double cosineOfQuarterTurns(double t) {
  const double whole = std::floor(t + 0.5);
  const double rest = t - whole;
  switch (static_cast<std::int64_t>(whole) & 3) {
  case 0: return smallCosine(rest);
  case 1: return -smallSine(rest);
  case 2: return -smallCosine(rest);
  default: return smallSine(rest);
  }
}

} // namespace volmark
