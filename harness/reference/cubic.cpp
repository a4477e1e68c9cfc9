#include "reference/cubic.h"

#include <algorithm>
#include <cmath>

namespace volmark::reference {

namespace {

double between(double a, double b, double share) {
  return a + (b - a) * share;
}

} // namespace

double Cubic::operator()(double s) const {
  // De Casteljau's scheme.
  const auto& k = coefficients;
  const double a = between(k[0], k[1], s);
  const double b = between(k[1], k[2], s);
  const double c = between(k[2], k[3], s);
  return between(between(a, b, s), between(b, c, s), s);
}

double Cubic::lowerBound() const {
  return *std::min_element(coefficients.begin(), coefficients.end());
}

double Cubic::upperBound() const {
  return *std::max_element(coefficients.begin(), coefficients.end());
}

Cubic cubicAlong(const Corners& corners, const glm::dvec3& from, const glm::dvec3& to, double level) {
  // The coefficients are means of the field at the corners of the box that the two points span: the trilinear
  // interpolant's polar form.
  Corners shifted;
  for (int i = 0; i < 8; ++i)
    shifted[i] = corners[i] - level;
  const auto at = [&](bool x, bool y, bool z) {
    return trilinear(shifted, {x ? to.x : from.x, y ? to.y : from.y, z ? to.z : from.z});
  };
  return {{at(false, false, false), (at(true, false, false) + at(false, true, false) + at(false, false, true)) / 3,
           (at(false, true, true) + at(true, false, true) + at(true, true, false)) / 3, at(true, true, true)}};
}

std::array<double, 3> monotoneEnds(const Cubic& cubic) {
  // The derivative's Bernstein coefficients (up to a factor of 3), then a s^2 + 2 b s + c.
  const auto& k = cubic.coefficients;
  const double d0 = k[1] - k[0];
  const double d1 = k[2] - k[1];
  const double d2 = k[3] - k[2];
  const double a = d0 - 2 * d1 + d2;
  const double b = d1 - d0;
  const double c = d0;

  std::array<double, 3> ends = {1, 1, 1};
  const double discriminant = b * b - a * c;
  if (!(discriminant > 0)) return ends;
  // The roots q/a and c/q lose no digits when b*b is much larger than a*c.
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  const auto inside = [](double root) { return root > 0 && root < 1 ? root : 1.0; };
  ends[0] = inside(q / a);
  ends[1] = inside(c / q);
  std::sort(ends.begin(), ends.end());
  return ends;
}

double crossing(const Cubic& cubic, double level, double low, double high) {
  constexpr double kResolution = 0x1p-54;
  const bool ascending = cubic(high) >= level;
  while (high - low > kResolution) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    ((cubic(middle) >= level) == ascending ? high : low) = middle;
  }
  return high;
}

std::optional<double> firstNonNegative(const Cubic& cubic) {
  if (cubic.coefficients[0] >= 0) return 0.0;
  if (cubic.upperBound() < 0) return std::nullopt;
  double start = 0;
  for (const double end : monotoneEnds(cubic)) {
    if (cubic(end) >= 0) return crossing(cubic, 0, start, end);
    start = end;
  }
  return std::nullopt;
}

} // namespace volmark::reference
