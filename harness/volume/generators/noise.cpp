#include "volume/generators/noise.h"

#include "volume/generators/portable_math.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace volmark {

namespace {

constexpr double kLowestValue = 0.02; ///< of the lattice that the scale is taken from

glm::dvec2 product(const glm::dvec2& a, const glm::dvec2& b) {
  return {a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x};
}

glm::dvec2 onUnitCircle(double quarterTurns) {
  return {cosineOfQuarterTurns(quarterTurns), sineOfQuarterTurns(quarterTurns)};
}

/// exp(i pi k position) for k from `first` to `last`.
std::vector<glm::dvec2> wavesAt(double position, int first, int last) {
  std::vector<glm::dvec2> result;
  for (int k = first; k <= last; ++k)
    result.push_back(onUnitCircle(2 * k * position));
  return result;
}

/// One of each pair of opposite vectors.
bool isChosen(int kx, int ky, int kz) {
  if (kx != 0) return kx > 0;
  if (ky != 0) return ky > 0;
  return kz > 0;
}

/// Depends on the vector alone, so that a wider band adds waves and keeps the others.
double phaseOf(int kx, int ky, int kz, std::uint32_t seed) {
  constexpr int side = 2 * Noise::kMaximumFrequency + 1;
  const int item =
      ((kz + Noise::kMaximumFrequency) * side + ky + Noise::kMaximumFrequency) * (Noise::kMaximumFrequency + 1) + kx;
  return 4 * randomUnit(seed, static_cast<std::uint32_t>(item), 0);
}

} // namespace

Noise::Noise(double beta, int lowest, int highest, std::uint32_t seed) : m_highest(highest) {
  for (int kz = -highest; kz <= highest; ++kz)
    for (int ky = -highest; ky <= highest; ++ky)
      for (int kx = 0; kx <= highest; ++kx) {
        const int squared = kx * kx + ky * ky + kz * kz;
        const bool inBand = squared >= lowest * lowest && squared <= highest * highest && isChosen(kx, ky, kz);
        const double amplitude = inBand ? power(squared, -beta / 4) : 0;
        m_waves.push_back(amplitude * onUnitCircle(phaseOf(kx, ky, kz, seed)));
      }

  const int count = 4 * highest;
  std::vector<double> lattice;
  for (int i = 0; i < count; ++i)
    lattice.push_back(-1 + 2.0 * i / count);
  std::vector<double> sums(lattice.size() * lattice.size());
  double low = 0;
  double high = 0;
  for (const double z : lattice) {
    sumWaves(lattice, lattice, z, sums);
    const auto [least, most] = std::minmax_element(sums.begin(), sums.end());
    low = std::min(low, *least);
    high = std::max(high, *most);
  }
  m_scale = (1 - 2 * kLowestValue) / (high - low);
  m_offset = kLowestValue - low * m_scale;
}

double Noise::scaled(double sum) const {
  return std::clamp(m_offset + m_scale * sum, 0.0, 1.0);
}

double Noise::value(const glm::dvec3& p) const {
  double value = 0;
  sampleSlice({&p.x, 1}, {&p.y, 1}, p.z, {&value, 1});
  return value;
}

void Noise::sampleSlice(std::span<const double> xs, std::span<const double> ys, double z,
                        std::span<double> values) const {
  sumWaves(xs, ys, z, values);
  for (double& value : values)
    value = scaled(value);
}

// exp(i pi k.p) is a product of three factors: the sum is taken over k.z once a slice, over k.y once a row.
void Noise::sumWaves(std::span<const double> xs, std::span<const double> ys, double z, std::span<double> values) const {
  const std::size_t wavesX = static_cast<std::size_t>(m_highest) + 1;
  const std::size_t wavesY = 2 * static_cast<std::size_t>(m_highest) + 1;
  std::vector<glm::dvec2> ofSlice(wavesX * wavesY, glm::dvec2(0.0));
  const std::vector<glm::dvec2> factorsZ = wavesAt(z, -m_highest, m_highest);
  for (std::size_t kz = 0; kz < factorsZ.size(); ++kz)
    for (std::size_t k = 0; k < ofSlice.size(); ++k)
      ofSlice[k] += product(m_waves[kz * ofSlice.size() + k], factorsZ[kz]);

  std::vector<double> cosines; // of wave k.x at xs, positions fastest
  std::vector<double> sines;
  for (std::size_t kx = 0; kx < wavesX; ++kx)
    for (const double x : xs) {
      const glm::dvec2 factor = onUnitCircle(2 * double(kx) * x);
      cosines.push_back(factor.x);
      sines.push_back(factor.y);
    }

  for (std::size_t j = 0; j < ys.size(); ++j) {
    std::vector<glm::dvec2> ofRow(wavesX, glm::dvec2(0.0));
    const std::vector<glm::dvec2> factorsY = wavesAt(ys[j], -m_highest, m_highest);
    for (std::size_t ky = 0; ky < wavesY; ++ky)
      for (std::size_t kx = 0; kx < wavesX; ++kx)
        ofRow[kx] += product(ofSlice[ky * wavesX + kx], factorsY[ky]);

    const std::span<double> row = values.subspan(j * xs.size(), xs.size());
    std::fill(row.begin(), row.end(), 0.0);
    for (std::size_t kx = 0; kx < wavesX; ++kx)
      for (std::size_t i = 0; i < xs.size(); ++i)
        row[i] += ofRow[kx].x * cosines[kx * xs.size() + i] - ofRow[kx].y * sines[kx * xs.size() + i];
  }
}

glm::dvec3 Noise::gradient(const glm::dvec3& p) const {
  if (const double here = value(p); here <= 0 || here >= 1) return glm::dvec3(0.0);
  const std::vector<glm::dvec2> factorsX = wavesAt(p.x, 0, m_highest);
  const std::vector<glm::dvec2> factorsY = wavesAt(p.y, -m_highest, m_highest);
  const std::vector<glm::dvec2> factorsZ = wavesAt(p.z, -m_highest, m_highest);
  glm::dvec3 sum(0.0);
  std::size_t next = 0;
  for (int kz = -m_highest; kz <= m_highest; ++kz)
    for (int ky = -m_highest; ky <= m_highest; ++ky) {
      const glm::dvec2 factor = product(factorsZ[static_cast<std::size_t>(kz + m_highest)],
                                        factorsY[static_cast<std::size_t>(ky + m_highest)]);
      for (int kx = 0; kx <= m_highest; ++kx) {
        const glm::dvec2 wave = product(m_waves[next++], product(factor, factorsX[static_cast<std::size_t>(kx)]));
        sum -= wave.y * glm::dvec3(kx, ky, kz);
      }
    }
  return m_scale * std::numbers::pi * sum;
}

} // namespace volmark
