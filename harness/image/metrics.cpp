#include "image/metrics.h"

#include "image/flip.h"
#include "image/ssim.h"

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

/// Two pictures over an opaque background. Where exactly one has a NaN, `broken` is set and it gets the opposite of
/// the other's number; where both have, both get 0.
struct Shown {
  Planes picture; ///< linear, not clamped
  Planes reference;
  std::vector<char> broken; ///< three channels a pixel
};

double opposite(double linear) {
  return encodeSrgb(std::clamp(linear, 0.0, 1.0)) < 0.5 ? 1 : 0;
}

Shown showOver(const glm::dvec3& background, const Picture& picture, const Picture& reference) {
  Shown shown{makePlanes(picture.width, picture.height), makePlanes(picture.width, picture.height),
              std::vector<char>(3 * picture.color.size())};
  for (std::size_t i = 0; i < picture.color.size(); ++i) {
    for (int channel = 0; channel < 3; ++channel) {
      const auto over = [&](const glm::vec4& color) { return color[channel] + (1.0 - color.a) * background[channel]; };
      double a = over(picture.color[i]);
      double b = over(reference.color[i]);
      const bool isBroken = std::isnan(a) != std::isnan(b);
      if (std::isnan(a)) a = isBroken ? opposite(b) : 0;
      if (std::isnan(b)) b = isBroken ? opposite(a) : 0;
      const auto c = static_cast<std::size_t>(channel);
      shown.picture[c].values[i] = a;
      shown.reference[c].values[i] = b;
      shown.broken[3 * i + c] = isBroken;
    }
  }
  return shown;
}

bool exceedsOne(const Planes& planes) {
  return std::any_of(planes.begin(), planes.end(), [](const Plane& plane) {
    return std::any_of(plane.values.begin(), plane.values.end(), [](double value) { return value > 1; });
  });
}

void clampAll(Planes& planes) {
  for (Plane& plane : planes)
    for (double& value : plane.values)
      value = std::clamp(value, 0.0, 1.0);
}

Plane encoded(Plane plane) {
  for (double& value : plane.values)
    value = encodeSrgb(value);
  return plane;
}

/// Mean of a FLIP map, 1 where a channel is broken.
double meanFlip(const Plane& map, const std::vector<char>& broken) {
  double sum = 0;
  for (std::size_t i = 0; i < map.values.size(); ++i)
    sum += broken[3 * i] || broken[3 * i + 1] || broken[3 * i + 2] ? 1 : map.values[i];
  return sum / static_cast<double>(map.values.size());
}

double squaredErrors(const Plane& a, const Plane& b, const std::vector<char>& broken, std::size_t channel) {
  double sum = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    const double difference = broken[3 * i + channel] ? 1 : a.values[i] - b.values[i];
    sum += difference * difference;
  }
  return sum;
}

/// MSE, PSNR and SSIM of clamped planes.
void compareEncoded(const Shown& shown, PictureErrors& errors) {
  double squares = 0;
  double similarity = 0;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const Plane a = encoded(shown.picture[channel]);
    const Plane b = encoded(shown.reference[channel]);
    squares += squaredErrors(a, b, shown.broken, channel);
    Plane map = ssimMap(a, b);
    for (std::size_t i = 0; i < map.values.size(); ++i)
      if (shown.broken[3 * i + channel]) map.values[i] = 0;
    const auto mean = meanSsim(map);
    similarity += mean.value_or(0) / 3;
    if (mean) errors.ssim = similarity;
  }
  errors.mse = squares / static_cast<double>(shown.broken.size());
  if (errors.mse > 0) errors.psnrDb = -10 * std::log10(errors.mse);
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

  Shown shown = showOver(background, picture, reference);
  if (exceedsOne(shown.picture) || exceedsOne(shown.reference))
    errors.flipHdr = meanFlip(hdrFlipMap(shown.picture, shown.reference), shown.broken);
  clampAll(shown.picture);
  clampAll(shown.reference);
  compareEncoded(shown, errors);
  errors.flip = meanFlip(flipMap(shown.picture, shown.reference), shown.broken);
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
