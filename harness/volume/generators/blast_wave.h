// A field that changes with time.
#pragma once

#include "volume/generators/generator.h"

#include <vector>

namespace volmark {

struct BlastWaveSettings {
  int timeSteps = 30;
  double instability = 0.3; ///< [0,1): share of its radius by which the last front is off the sphere at most
  double frontWidth = 0.05; ///< over which the density falls from the front to the air
  std::uint32_t seed = 1;
};

/// Density of a point explosion in a gas of adiabatic index 7/5 (Sedov 1946, Taylor 1950), relative to that at the
/// front: 1/6 outside (a strong shock compresses six times), (r/R)^15 inside, the power law that holds the mass swept
/// up. The front is at R = kLastRadius ((step+1)/timeSteps)^(2/5), wrinkled by waves over the directions that
/// grow in proportion to R. Differs from Sedov and Taylor: a power law for the profile, a soft front.
class BlastWave : public Field {
public:
  static constexpr double kLastRadius = 0.72;
  static constexpr double kAir = 1.0 / 6;

  /// `step`: from 0 to timeSteps-1.
  BlastWave(const BlastWaveSettings& settings, int step);

  double value(const glm::dvec3& p) const override;
  glm::dvec3 gradient(const glm::dvec3& p) const override;
  /// Of the front before it is wrinkled.
  double frontRadius() const { return m_radius; }

private:
  struct Wave {
    glm::dvec3 vector; ///< quarter turns per unit length
    double phase;      ///< quarter turns
  };
  /// Front radius in the direction of a unit vector.
  double frontTowards(const glm::dvec3& direction) const;
  /// Gradient of that at `distance` from the centre.
  glm::dvec3 frontGradient(const glm::dvec3& direction, double distance) const;

  std::vector<Wave> m_waves;
  double m_radius;
  double m_wrinkles; ///< [0,1)
  double m_frontWidth;
};

} // namespace volmark
