// The trilinear field along a straight line through a cell: a cubic.
#pragma once

#include "reference/field.h"

#include <array>
#include <optional>

namespace volmark::reference {

/// In Bernstein form over [0,1]: evaluation is stable and the curve lies between the least and greatest coefficient.
struct Cubic {
  std::array<double, 4> coefficients;

  double operator()(double s) const;
  double lowerBound() const;
  double upperBound() const;
};

/// The trilinear interpolant of `corners` on the line between two points of the cell, minus `level`.
Cubic cubicAlong(const Corners& corners, const glm::dvec3& from, const glm::dvec3& to, double level = 0);

/// Ends of the monotone pieces: where the derivative vanishes inside (0,1), ascending; what is left is 1.
std::array<double, 3> monotoneEnds(const Cubic& cubic);

/// Where a cubic that is monotone on [low, high] passes from one side of `level` to the other, to double precision: the
/// end of the last interval, on the side of `high`.
double crossing(const Cubic& cubic, double level, double low, double high);

/// The least s in [0,1] with cubic(s) >= 0, to double precision; nothing if the cubic stays negative. Isolates the
/// monotone pieces at the roots of the derivative, as Marmitt et al. 2004 (Fast and Accurate Ray-Voxel Intersection
/// Techniques for Iso-Surface Ray Tracing, section 3.3), then bisects.
std::optional<double> firstNonNegative(const Cubic& cubic);

} // namespace volmark::reference
