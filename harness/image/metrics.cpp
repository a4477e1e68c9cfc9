#include "image/metrics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

namespace volmark {

namespace {

/// IEC 61966-2-1, for linear values in [0,1].
double encodeSrgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

/// One channel of a premultiplied colour over an opaque background, as it is shown.
double shown(const glm::vec4& color, int channel, const glm::dvec3& background) {
  const double over = color[channel] + (1.0 - color.a) * background[channel];
  return std::isnan(over) ? over : encodeSrgb(std::clamp(over, 0.0, 1.0));
}

/// Not a number is as wrong as can be, unless both are.
double squaredError(double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) && std::isnan(b) ? 0 : 1;
  return (a - b) * (a - b);
}

/// Linear interpolation between the closest ranks. Orders `values`, which must not be empty.
double quantile(std::vector<double>& values, double share) {
  std::sort(values.begin(), values.end());
  const double rank = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (rank - static_cast<double>(below)) * (values[above] - values[below]);
}

} // namespace

PictureErrors compareColor(const Picture& picture, const Picture& reference, const glm::dvec3& background) {
  assert(picture.width == reference.width && picture.height == reference.height);
  assert(picture.color.size() == reference.color.size() && !picture.color.empty());
  PictureErrors errors;
  errors.identical =
      std::memcmp(picture.color.data(), reference.color.data(), picture.color.size() * sizeof(glm::vec4)) == 0;

  double sum = 0;
  for (std::size_t i = 0; i < picture.color.size(); ++i)
    for (int channel = 0; channel < 3; ++channel)
      sum += squaredError(shown(picture.color[i], channel, background), shown(reference.color[i], channel, background));
  errors.mse = sum / (3.0 * static_cast<double>(picture.color.size()));
  if (errors.mse > 0) errors.psnrDb = -10 * std::log10(errors.mse);
  return errors;
}

void compareDistance(const Picture& picture, const Picture& reference, double voxelMm, PictureErrors& errors) {
  assert(picture.distance.size() == picture.color.size() && reference.distance.size() == reference.color.size());
  assert(picture.distance.size() == reference.distance.size() && voxelMm > 0);
  std::vector<double> depths;
  double missed = 0;
  double spurious = 0;
  for (std::size_t i = 0; i < picture.distance.size(); ++i) {
    const bool hit = std::isfinite(picture.distance[i]);
    const bool referenceHit = std::isfinite(reference.distance[i]);
    missed += referenceHit && !hit;
    spurious += hit && !referenceHit;
    if (hit && referenceHit) depths.push_back(std::abs(double(picture.distance[i]) - reference.distance[i]) / voxelMm);
  }

  const double referenceHits = missed + static_cast<double>(depths.size());
  if (referenceHits > 0) {
    errors.missedShare = missed / referenceHits;
    errors.spuriousShare = spurious / referenceHits;
  }
  if (depths.empty()) return;
  double sum = 0;
  for (const double depth : depths)
    sum += depth;
  errors.depthMeanVoxels = sum / static_cast<double>(depths.size());
  errors.depthP995Voxels = quantile(depths, 0.995);
  errors.depthMaxVoxels = depths.back();
}

} // namespace volmark
