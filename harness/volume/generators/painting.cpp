#include "volume/generators/painting.h"

#include "volume/generators/portable_math.h"

#include <algorithm>
#include <cmath>

namespace volmark {

Ellipsoid::Ellipsoid(const glm::dvec3& centre, const glm::dvec3& semiAxes, double edgeWidth)
    : m_centre(centre), m_semiAxes(semiAxes), m_perRadius(std::min({semiAxes.x, semiAxes.y, semiAxes.z}) / edgeWidth) {
}

double Ellipsoid::value(const glm::dvec3& p) const {
  const glm::dvec3 scaled = (p - m_centre) / m_semiAxes;
  const double radius = std::sqrt(scaled.x * scaled.x + scaled.y * scaled.y + scaled.z * scaled.z);
  return smoothStep((1 - radius) * m_perRadius + 0.5);
}

glm::dvec3 Ellipsoid::gradient(const glm::dvec3& p) const {
  const glm::dvec3 scaled = (p - m_centre) / m_semiAxes;
  const double radius = std::sqrt(scaled.x * scaled.x + scaled.y * scaled.y + scaled.z * scaled.z);
  const double slope = smoothStepSlope((1 - radius) * m_perRadius + 0.5);
  // At the centre, where the radius has no gradient, the share is constant.
  if (slope == 0) return glm::dvec3(0.0);
  return -slope * m_perRadius * (scaled / m_semiAxes / radius);
}

Barrel::Barrel(const glm::dvec3& semiAxes, double edgeWidth)
    : m_semiAxes(semiAxes), m_perRadius(std::min({semiAxes.x, semiAxes.y, semiAxes.z}) / edgeWidth) {
}

double Barrel::radius(const glm::dvec3& p) const {
  const glm::dvec3 scaled = p / m_semiAxes;
  const double across = scaled.x * scaled.x + scaled.y * scaled.y;
  const double along = scaled.z * scaled.z;
  return std::sqrt(std::sqrt(across * across + along * along));
}

double Barrel::value(const glm::dvec3& p) const {
  return smoothStep((1 - radius(p)) * m_perRadius + 0.5);
}

glm::dvec3 Barrel::gradient(const glm::dvec3& p) const {
  const double r = radius(p);
  const double slope = smoothStepSlope((1 - r) * m_perRadius + 0.5);
  if (slope == 0) return glm::dvec3(0.0);
  const glm::dvec3 scaled = p / m_semiAxes;
  const double across = scaled.x * scaled.x + scaled.y * scaled.y;
  const double along = scaled.z * scaled.z;
  const glm::dvec3 weighted = glm::dvec3(across, across, along) * scaled / m_semiAxes;
  return -slope * m_perRadius / (r * r * r) * weighted;
}

double Painting::value(const glm::dvec3& p) const {
  double value = 0;
  for (const Layer& layer : m_layers)
    value += (layer.plateau - value) * layer.share->value(p);
  return value;
}

glm::dvec3 Painting::gradient(const glm::dvec3& p) const {
  double value = 0;
  glm::dvec3 gradient(0.0);
  for (const Layer& layer : m_layers) {
    const double share = layer.share->value(p);
    gradient = (1 - share) * gradient + (layer.plateau - value) * layer.share->gradient(p);
    value += (layer.plateau - value) * share;
  }
  return gradient;
}

void Painting::sampleSlice(std::span<const double> xs, std::span<const double> ys, double z,
                           std::span<double> values) const {
  std::vector<double> shares(values.size());
  std::fill(values.begin(), values.end(), 0.0);
  for (const Layer& layer : m_layers) {
    layer.share->sampleSlice(xs, ys, z, shares);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] += (layer.plateau - values[i]) * shares[i];
  }
}

double LabelPainting::value(const glm::dvec3& p) const {
  for (auto layer = m_layers.rbegin(); layer != m_layers.rend(); ++layer)
    if (layer->share->value(p) >= 0.5) return layer->label;
  return 0;
}

void LabelPainting::sampleSlice(std::span<const double> xs, std::span<const double> ys, double z,
                                std::span<double> values) const {
  std::vector<double> shares(values.size());
  std::fill(values.begin(), values.end(), 0.0);
  for (const Layer& layer : m_layers) {
    layer.share->sampleSlice(xs, ys, z, shares);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (shares[i] >= 0.5) values[i] = layer.label;
  }
}

} // namespace volmark
