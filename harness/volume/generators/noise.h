// Random fields with a given spectrum.
#pragma once

#include "volume/generators/generator.h"

#include <vector>

namespace volmark {

/// Random-phase synthesis: the sum of one wave for each wave vector k of whole cycles over the cube's width with
/// lowest <= |k| <= highest, of amplitude |k|^(-beta/2) and a random phase; opposite vectors are one wave. The power
/// spectral density is |k|^-beta within the band and 0 outside: beta 0 is white noise, 11/3 that of a scalar in
/// turbulence (Kolmogorov). The field repeats with the cube.
///
/// Scaled so that the extremes over a lattice of four points a wave are 0.02 and 0.98; what little goes beyond 0 or
/// 1 is clamped.
class Noise : public Field {
public:
  /// 1 <= lowest <= highest <= kMaximumFrequency, in cycles over the cube's width.
  Noise(double beta, int lowest, int highest, std::uint32_t seed);
  static constexpr int kMaximumFrequency = 32;

  double value(const glm::dvec3& p) const override;
  glm::dvec3 gradient(const glm::dvec3& p) const override;
  void sampleSlice(std::span<const double> xs, std::span<const double> ys, double z,
                   std::span<double> values) const override;

private:
  /// The sum before it is scaled.
  void sumWaves(std::span<const double> xs, std::span<const double> ys, double z, std::span<double> values) const;
  double scaled(double sum) const;

  int m_highest;
  /// Amplitude and phase as a complex number: k.z and k.y from -highest to highest, k.x (fastest) from 0 to highest.
  std::vector<glm::dvec2> m_waves;
  double m_offset = 0;
  double m_scale = 1;
};

} // namespace volmark
