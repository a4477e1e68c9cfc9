#include "volumes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

namespace volmark::gpu::test {

namespace {

template <class T> std::vector<std::byte> randomVoxels(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  const bool isFloat = std::is_floating_point_v<T>;
  const double low = isFloat ? -3 : double(std::numeric_limits<T>::lowest());
  const double high = isFloat ? 5 : double(std::numeric_limits<T>::max());
  std::uniform_real_distribution<double> uniform(low, high);
  std::vector<T> values(count);
  for (T& value : values)
    value = static_cast<T>(isFloat ? uniform(random) : std::round(uniform(random)));
  values[0] = static_cast<T>(low);
  if (count > 1) values[1] = static_cast<T>(low + (isFloat ? 0.5 : 1));
  if (count > 2) values[2] = static_cast<T>(high);
  std::vector<std::byte> bytes(count * sizeof(T));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

std::vector<std::byte> randomVoxels(ScalarType type, std::size_t count, std::uint32_t seed) {
  switch (type) {
  case ScalarType::int8: return randomVoxels<std::int8_t>(count, seed);
  case ScalarType::uint8: return randomVoxels<std::uint8_t>(count, seed);
  case ScalarType::int16: return randomVoxels<std::int16_t>(count, seed);
  case ScalarType::uint16: return randomVoxels<std::uint16_t>(count, seed);
  case ScalarType::float32: return randomVoxels<float>(count, seed);
  }
  return {};
}

} // namespace

std::shared_ptr<const Volume> randomVolume(ScalarType type, glm::ivec3 dims, glm::dvec3 spacing, int timeSteps,
                                           std::uint32_t seed) {
  const Grid grid{dims, spacing};
  auto voxels = randomVoxels(type, grid.voxelCount() * static_cast<std::size_t>(timeSteps), seed);
  return std::make_shared<Volume>("random", grid, type, std::move(voxels), timeSteps);
}

Scene sceneOf(std::shared_ptr<const Volume> volume) {
  Scene scene;
  scene.name = "test";
  scene.visualisationRange = volume->dataRange();
  scene.volume = std::move(volume);
  return scene;
}

double fieldAt(const Scene& scene, const glm::dvec3& world, int timeStep) {
  const Volume& volume = *scene.volume;
  const Grid& grid = volume.grid();
  const glm::dvec3 voxel = glm::clamp(grid.toVoxel(world), glm::dvec3(0), glm::dvec3(grid.dims - 1));
  const glm::ivec3 low(glm::floor(voxel));
  const glm::dvec3 fraction = voxel - glm::dvec3(low);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 offset(corner & 1, corner >> 1 & 1, corner >> 2);
    const glm::dvec3 weights = glm::mix(1.0 - fraction, fraction, glm::dvec3(offset));
    const glm::ivec3 index = glm::min(low + offset, grid.dims - 1);
    sum += weights.x * weights.y * weights.z * volume.value(index.x, index.y, index.z, timeStep);
  }
  return std::clamp(scene.normalised(sum), 0.0, 1.0);
}

glm::dvec3 gradientAt(const Scene& scene, const glm::dvec3& world) {
  const Grid& grid = scene.volume->grid();
  glm::dvec3 gradient(0);
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 ahead = world, behind = world;
    ahead[axis] = std::min(world[axis] + grid.spacingMm[axis], grid.boxMaximum()[axis]);
    behind[axis] = std::max(world[axis] - grid.spacingMm[axis], grid.boxMinimum()[axis]);
    const double distance = ahead[axis] - behind[axis];
    if (distance > 0) gradient[axis] = (fieldAt(scene, ahead) - fieldAt(scene, behind)) / distance;
  }
  return gradient;
}

} // namespace volmark::gpu::test
