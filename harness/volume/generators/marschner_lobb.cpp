#include "volume/generators/fields.h"
#include "volume/generators/portable_math.h"

#include <cmath>
#include <numbers>

namespace volmark {

// rho(x,y,z) = (1 - sin(pi z/2) + alpha (1 + rho_r(sqrt(x^2+y^2)))) / (2 (1 + alpha))
// rho_r(r) = cos(2 pi f_M cos(pi r/2))
double MarschnerLobb::value(const glm::dvec3& p) const {
  const double r = std::sqrt(p.x * p.x + p.y * p.y);
  const double radial = cosineOfQuarterTurns(4 * m_frequency * cosineOfQuarterTurns(r));
  return (1 - sineOfQuarterTurns(p.z) + m_amplitude * (1 + radial)) / (2 * (1 + m_amplitude));
}

glm::dvec3 MarschnerLobb::gradient(const glm::dvec3& p) const {
  constexpr double pi = std::numbers::pi;
  const double scale = 1 / (2 * (1 + m_amplitude));
  const double r = std::sqrt(p.x * p.x + p.y * p.y);
  // d rho_r / dr = pi^2 f_M sin(2 pi f_M cos(pi r/2)) sin(pi r/2); over r, whose limit at the axis is finite.
  const double sineOverRadius = r > 0 ? sineOfQuarterTurns(r) / r : pi / 2;
  const double slopeOverRadius =
      pi * pi * m_frequency * sineOfQuarterTurns(4 * m_frequency * cosineOfQuarterTurns(r)) * sineOverRadius;
  const double inPlane = scale * m_amplitude * slopeOverRadius;
  return {inPlane * p.x, inPlane * p.y, -scale * (pi / 2) * cosineOfQuarterTurns(p.z)};
}

} // namespace volmark
