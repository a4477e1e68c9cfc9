#include "volume/generators/fields.h"
#include "volume/generators/portable_math.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace volmark {

double DistanceField::value(const glm::dvec3& p) const {
  return std::clamp(0.5 - distance(p) / (2 * m_band), 0.0, 1.0);
}

glm::dvec3 DistanceField::gradient(const glm::dvec3& p) const {
  if (std::abs(distance(p)) >= m_band) return glm::dvec3(0.0);
  return direction(p) / (-2 * m_band);
}

double Sphere::distance(const glm::dvec3& p) const {
  return std::sqrt(glm::dot(p, p)) - m_radius;
}

glm::dvec3 Sphere::direction(const glm::dvec3& p) const {
  const double length = std::sqrt(glm::dot(p, p));
  return length > 0 ? p / length : glm::dvec3(0.0);
}

double Torus::distance(const glm::dvec3& p) const {
  const double outwards = std::sqrt(p.x * p.x + p.y * p.y) - m_majorRadius;
  return std::sqrt(outwards * outwards + p.z * p.z) - m_minorRadius;
}

glm::dvec3 Torus::direction(const glm::dvec3& p) const {
  const double axisDistance = std::sqrt(p.x * p.x + p.y * p.y);
  const double outwards = axisDistance - m_majorRadius;
  const double length = std::sqrt(outwards * outwards + p.z * p.z);
  if (axisDistance == 0 || length == 0) return glm::dvec3(0.0);
  return {outwards / length * p.x / axisDistance, outwards / length * p.y / axisDistance, p.z / length};
}

double Gyroid::value(const glm::dvec3& p) const {
  const glm::dvec3 t = m_quarterTurns * p;
  const double level = sineOfQuarterTurns(t.x) * cosineOfQuarterTurns(t.y) +
                       sineOfQuarterTurns(t.y) * cosineOfQuarterTurns(t.z) +
                       sineOfQuarterTurns(t.z) * cosineOfQuarterTurns(t.x);
  return std::clamp(0.5 + level / 3, 0.0, 1.0);
}

glm::dvec3 Gyroid::gradient(const glm::dvec3& p) const {
  const glm::dvec3 t = m_quarterTurns * p;
  const glm::dvec3 sine(sineOfQuarterTurns(t.x), sineOfQuarterTurns(t.y), sineOfQuarterTurns(t.z));
  const glm::dvec3 cosine(cosineOfQuarterTurns(t.x), cosineOfQuarterTurns(t.y), cosineOfQuarterTurns(t.z));
  const glm::dvec3 slope(cosine.x * cosine.y - sine.z * sine.x, cosine.y * cosine.z - sine.x * sine.y,
                         cosine.z * cosine.x - sine.y * sine.z);
  return slope * (m_quarterTurns * std::numbers::pi / 2 / 3);
}

} // namespace volmark
