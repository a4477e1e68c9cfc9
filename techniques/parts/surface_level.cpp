#include "parts/surface_level.h"

#include <cmath>
#include <limits>

namespace volmark::parts {

namespace {

struct Integers {
  double smallest;
  double count; ///< of steps from the smallest to the largest one: texel 1.0
};

Integers integersOf(ScalarType type) {
  switch (type) {
  case ScalarType::int8: return {-128, 255};
  case ScalarType::uint8: return {0, 255};
  case ScalarType::int16: return {-32768, 65535};
  default: return {0, 65535};
  }
}

} // namespace

SurfaceLevel surfaceLevel(const Scene& scene, double isovalue) {
  // Clamped scalars are never below 0 and never above 1.
  constexpr float infinity = std::numeric_limits<float>::infinity();
  if (isovalue <= 0) return {-infinity, 0};
  if (isovalue > 1) return {infinity, 0};
  const Range& range = scene.visualisationRange;
  const double raw = range.minimum + isovalue * (range.maximum - range.minimum);
  const ScalarType type = scene.volume->type();
  if (type == ScalarType::float32) {
    // The smallest float that is not below the isovalue.
    auto level = static_cast<float>(raw);
    if (level < raw) level = std::nextafter(level, infinity);
    return {level, level};
  }
  const Integers integers = integersOf(type);
  double stored = raw - integers.smallest;
  if (std::abs(stored - std::round(stored)) <= 1e-6) stored = std::round(stored);
  return {static_cast<float>((std::ceil(stored) - 0.5) / integers.count), static_cast<float>(stored / integers.count)};
}

} // namespace volmark::parts
