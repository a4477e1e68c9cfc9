#include "volume/generators/blast_wave.h"

#include "volume/generators/portable_math.h"

#include <cmath>
#include <numbers>

namespace volmark {

namespace {

constexpr int kWaves = 12;
constexpr double kShortestVector = 5; ///< of the waves, quarter turns per unit length
constexpr double kLongestVector = 14;

glm::dvec3 randomDirection(std::uint32_t seed, std::uint32_t item) {
  const double z = 2 * randomUnit(seed, item, 0) - 1;
  const double turn = 4 * randomUnit(seed, item, 1);
  const double inPlane = std::sqrt(1 - z * z);
  return {inPlane * cosineOfQuarterTurns(turn), inPlane * sineOfQuarterTurns(turn), z};
}

} // namespace

BlastWave::BlastWave(const BlastWaveSettings& settings, int step)
    : m_radius(kLastRadius * power((step + 1.0) / settings.timeSteps, 0.4)),
      m_wrinkles(settings.instability * m_radius / kLastRadius), m_frontWidth(settings.frontWidth) {
  for (std::uint32_t i = 0; i < kWaves; ++i) {
    const double length = kShortestVector + (kLongestVector - kShortestVector) * randomUnit(settings.seed, i, 2);
    m_waves.push_back({length * randomDirection(settings.seed, i), 4 * randomUnit(settings.seed, i, 3)});
  }
}

double BlastWave::frontTowards(const glm::dvec3& direction) const {
  double sum = 0;
  for (const Wave& wave : m_waves)
    sum += cosineOfQuarterTurns(glm::dot(wave.vector, direction) + wave.phase);
  return m_radius * (1 + m_wrinkles * sum / kWaves);
}

glm::dvec3 BlastWave::frontGradient(const glm::dvec3& direction, double distance) const {
  glm::dvec3 sum(0.0);
  for (const Wave& wave : m_waves) {
    const double along = glm::dot(wave.vector, direction);
    const glm::dvec3 across = (wave.vector - along * direction) / distance;
    sum -= std::numbers::pi / 2 * sineOfQuarterTurns(along + wave.phase) * across;
  }
  return m_radius * m_wrinkles / kWaves * sum;
}

double BlastWave::value(const glm::dvec3& p) const {
  const double distance = std::sqrt(glm::dot(p, p));
  if (distance == 0) return 0;
  if (distance >= m_radius * (1 + m_wrinkles) + m_frontWidth) return kAir;
  const double front = frontTowards(p / distance);
  if (distance > front) return kAir + (1 - kAir) * smoothStep(1 - (distance - front) / m_frontWidth);
  const double u = distance / front;
  const double u3 = u * u * u;
  const double u6 = u3 * u3;
  return u6 * u6 * u3;
}

glm::dvec3 BlastWave::gradient(const glm::dvec3& p) const {
  const double distance = std::sqrt(glm::dot(p, p));
  if (distance == 0 || distance >= m_radius * (1 + m_wrinkles) + m_frontWidth) return glm::dvec3(0.0);
  const glm::dvec3 direction = p / distance;
  const double front = frontTowards(direction);
  const glm::dvec3 slope = frontGradient(direction, distance);
  if (distance > front) {
    const double step = smoothStepSlope(1 - (distance - front) / m_frontWidth);
    return (1 - kAir) * step / m_frontWidth * (slope - direction);
  }
  const double u = distance / front;
  const double u7 = u * u * u * u * u * u * u;
  return 15 * u7 * u7 / front * (direction - u * slope);
}

} // namespace volmark
