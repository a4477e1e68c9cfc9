#include "volume/histogram.h"

#include <algorithm>
#include <cstring>

namespace volmark {

namespace {

template <class T> void count(std::span<const std::byte> bytes, Histogram& histogram, double& sum) {
  const double bins = static_cast<double>(histogram.counts.size());
  const double width = histogram.range.maximum - histogram.range.minimum;
  const double scale = width > 0 ? bins / width : 0;
  for (std::size_t i = 0; i + sizeof(T) <= bytes.size(); i += sizeof(T)) {
    T stored;
    std::memcpy(&stored, bytes.data() + i, sizeof(T));
    const auto value = static_cast<double>(stored);
    const double place = (value - histogram.range.minimum) * scale;
    ++histogram.counts[static_cast<std::size_t>(std::clamp(place, 0.0, bins - 1))];
    sum += value;
  }
}

} // namespace

Histogram histogramOf(const Volume& volume, int bins) {
  Histogram histogram;
  histogram.range = volume.dataRange();
  histogram.counts.resize(static_cast<std::size_t>(bins));
  double sum = 0;
  for (int step = 0; step < volume.timeSteps(); ++step) {
    const auto bytes = volume.voxels(step);
    switch (volume.type()) {
    case ScalarType::int8: count<std::int8_t>(bytes, histogram, sum); break;
    case ScalarType::uint8: count<std::uint8_t>(bytes, histogram, sum); break;
    case ScalarType::int16: count<std::int16_t>(bytes, histogram, sum); break;
    case ScalarType::uint16: count<std::uint16_t>(bytes, histogram, sum); break;
    case ScalarType::float32: count<float>(bytes, histogram, sum); break;
    }
  }
  histogram.mean = sum / (static_cast<double>(volume.grid().voxelCount()) * volume.timeSteps());
  return histogram;
}

} // namespace volmark
