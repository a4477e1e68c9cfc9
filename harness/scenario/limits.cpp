#include "scenario/point_reading.h"

#include <algorithm>
#include <cmath>

namespace volmark {

namespace {

std::int64_t scaledDown(std::int64_t value, double factor, std::int64_t minimum) {
  return std::max(minimum, static_cast<std::int64_t>(std::floor(static_cast<double>(value) * factor)));
}

void limitPixels(std::int64_t limit, PointSettings& settings) {
  const std::int64_t pixels = std::int64_t(settings.width) * settings.height;
  if (pixels <= limit) return;
  const double factor = std::sqrt(double(limit) / double(pixels));
  // A side that would vanish keeps one pixel; the longer one gives way to it.
  std::int64_t width = scaledDown(settings.width, factor, 1);
  std::int64_t height = scaledDown(settings.height, factor, 1);
  if (width >= height)
    width = std::min(width, limit / height);
  else
    height = std::min(height, limit / width);
  settings.width = static_cast<int>(width);
  settings.height = static_cast<int>(height);
}

void limitVoxels(std::int64_t limit, GeneratorSettings& generator) {
  const glm::ivec3 before = generator.dims;
  const double voxels = double(before.x) * before.y * before.z;
  double factor = std::cbrt(double(limit) / voxels);
  if (factor >= 1) return;
  const auto count = [&] { return std::int64_t(generator.dims.x) * generator.dims.y * generator.dims.z; };
  // Rounding is downwards except at two voxels an axis, which a cell needs: then the others give way.
  do {
    for (int i = 0; i < 3; ++i)
      generator.dims[i] = static_cast<int>(scaledDown(before[i], factor, std::min(2, before[i])));
    factor *= 0.99;
  } while (count() > limit && (generator.dims.x > 2 || generator.dims.y > 2 || generator.dims.z > 2));
  for (int i = 0; i < 3; ++i)
    if (generator.dims[i] > 1) generator.spacingMm[i] *= double(before[i] - 1) / (generator.dims[i] - 1);
}

} // namespace

void applyLimits(const Limits& limits, PointSettings& settings) {
  if (limits.pixels) limitPixels(*limits.pixels, settings);
  if (limits.frames)
    settings.pacing.frames = static_cast<int>(std::min<std::int64_t>(settings.pacing.frames, *limits.frames));
  if (!limits.voxels) return;
  settings.maximumVoxels = *limits.voxels;
  if (auto* source = std::get_if<GeneratorSource>(&settings.scene.source))
    limitVoxels(*limits.voxels, source->settings);
}

} // namespace volmark
