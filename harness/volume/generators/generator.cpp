#include "volume/generators/generator.h"

#include "volume/voxel_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <functional>
#include <future>
#include <limits>
#include <thread>

namespace volmark {

namespace {

std::vector<double> axisPositions(int count) {
  std::vector<double> positions(static_cast<std::size_t>(count), 0.0);
  if (count == 1) return positions;
  for (int i = 0; i < count; ++i)
    positions[static_cast<std::size_t>(i)] = -1 + 2.0 * i / (count - 1);
  return positions;
}

template <class T> void storeVoxels(std::span<const double> values, double unit, std::byte* target) {
  const double low = std::numeric_limits<T>::lowest();
  const double high = std::numeric_limits<T>::max();
  for (const double value : values) {
    T voxel;
    if constexpr (std::is_floating_point_v<T>)
      voxel = static_cast<T>(value);
    else
      voxel = static_cast<T>(std::clamp(std::floor(value * unit + 0.5), low, high));
    std::memcpy(target, &voxel, sizeof(T));
    target += sizeof(T);
  }
}

void storeVoxels(ScalarType type, std::span<const double> values, double unit, std::byte* target) {
  switch (type) {
  case ScalarType::int8: return storeVoxels<std::int8_t>(values, unit, target);
  case ScalarType::uint8: return storeVoxels<std::uint8_t>(values, unit, target);
  case ScalarType::int16: return storeVoxels<std::int16_t>(values, unit, target);
  case ScalarType::uint16: return storeVoxels<std::uint16_t>(values, unit, target);
  case ScalarType::float32: return storeVoxels<float>(values, unit, target);
  }
}

/// Calls work(0) to work(count-1), each once, from several threads. Passes on an exception of one of them.
void forEach(int count, int threads, const std::function<void(int)>& work) {
  if (threads == 0) threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::atomic<int> next = 0;
  std::vector<std::future<void>> workers;
  for (int i = 0; i < std::min(threads, count); ++i)
    workers.push_back(std::async(std::launch::async, [&] {
      for (int item = next++; item < count; item = next++)
        work(item);
    }));
  for (std::future<void>& worker : workers)
    worker.get();
}

} // namespace

void Field::sampleSlice(std::span<const double> xs, std::span<const double> ys, double z,
                        std::span<double> values) const {
  auto next = values.begin();
  for (const double y : ys)
    for (const double x : xs)
      *next++ = value({x, y, z});
}

std::shared_ptr<const Volume> generateVolume(const GeneratorSettings& settings, int threads) {
  const int timeSteps = timeStepsOf(settings);
  const std::string place = fmt::format("generator {}", settings.name);
  const Grid grid{settings.dims, settings.spacingMm};
  std::vector<std::byte> bytes = allocateVoxels(
      place, checkedVoxelBytes(place, grid, settings.type, timeSteps, std::numeric_limits<std::uint64_t>::max()));
  std::vector<std::unique_ptr<Field>> fields;
  for (int step = 0; step < timeSteps; ++step)
    fields.push_back(makeField(settings, step));

  const double unit = voxelUnit(settings);
  const std::vector<double> xs = axisPositions(settings.dims.x);
  const std::vector<double> ys = axisPositions(settings.dims.y);
  const std::vector<double> zs = axisPositions(settings.dims.z);
  const std::size_t sliceBytes = xs.size() * ys.size() * sizeOf(settings.type);
  forEach(timeSteps * settings.dims.z, threads, [&](int slice) {
    std::vector<double> values(xs.size() * ys.size());
    const Field& field = *fields[static_cast<std::size_t>(slice / settings.dims.z)];
    field.sampleSlice(xs, ys, zs[static_cast<std::size_t>(slice % settings.dims.z)], values);
    storeVoxels(settings.type, values, unit, bytes.data() + static_cast<std::size_t>(slice) * sliceBytes);
  });
  return std::make_shared<const Volume>(settings.name, grid, settings.type, std::move(bytes), timeSteps);
}

} // namespace volmark
