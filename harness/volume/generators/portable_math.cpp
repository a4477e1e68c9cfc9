#include "volume/generators/portable_math.h"

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

double power(double x, double y) {
  // x = m 2^e with m in [sqrt(1/2), sqrt(2)); ln m = 2 artanh((m-1)/(m+1)), whose terms fall by 1/34.
  int e = 0;
  double m = std::frexp(x, &e);
  if (m < std::numbers::sqrt2 / 2) {
    m *= 2;
    --e;
  }
  const double z = (m - 1) / (m + 1);
  double sum = 0;
  for (int n = 25; n >= 1; n -= 2)
    sum = sum * z * z + 1.0 / n;
  const double exponent = y * (e + 2 * z * sum / std::numbers::ln2);

  // 2^exponent = 2^whole exp(rest), |rest| <= ln(2)/2.
  const double whole = std::floor(exponent + 0.5);
  const double rest = (exponent - whole) * std::numbers::ln2;
  double result = 1;
  for (int n = 18; n >= 1; --n)
    result = 1 + rest / n * result;
  return std::ldexp(result, static_cast<int>(whole));
}

double smoothStep(double t) {
  if (t <= 0) return 0;
  if (t >= 1) return 1;
  return t * t * t * (t * (6 * t - 15) + 10);
}

double smoothStepSlope(double t) {
  if (t <= 0 || t >= 1) return 0;
  return 30 * t * t * (t - 1) * (t - 1);
}

} // namespace volmark
