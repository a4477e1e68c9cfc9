#include "reference/field.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace volmark::reference {

namespace {

template <class Voxel> void convert(std::span<const std::byte> bytes, std::vector<float>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    Voxel voxel;
    std::memcpy(&voxel, bytes.data() + i * sizeof(Voxel), sizeof(Voxel));
    values[i] = static_cast<float>(voxel);
  }
}

std::vector<float> toFloat(const Volume& volume, int timeStep) {
  const std::span<const std::byte> bytes = volume.voxels(timeStep);
  std::vector<float> values(volume.grid().voxelCount());
  switch (volume.type()) {
  case ScalarType::int8: convert<std::int8_t>(bytes, values); break;
  case ScalarType::uint8: convert<std::uint8_t>(bytes, values); break;
  case ScalarType::int16: convert<std::int16_t>(bytes, values); break;
  case ScalarType::uint16: convert<std::uint16_t>(bytes, values); break;
  case ScalarType::float32: convert<float>(bytes, values); break;
  }
  return values;
}

/// This form is exact where both ends are equal.
double between(double a, double b, double share) {
  return a + (b - a) * share;
}

} // namespace

double trilinear(const Corners& c, const glm::dvec3& local) {
  const double front = between(between(c[0], c[1], local.x), between(c[2], c[3], local.x), local.y);
  const double back = between(between(c[4], c[5], local.x), between(c[6], c[7], local.x), local.y);
  return between(front, back, local.z);
}

Field::Field(const Scene& scene, int timeStep)
    : m_grid(scene.volume->grid()), m_range(scene.visualisationRange), m_raw(toFloat(*scene.volume, timeStep)) {
  assert(m_range.minimum < m_range.maximum);
}

glm::dvec3 Field::toVoxel(const glm::dvec3& world) const {
  return world / m_grid.spacingMm + 0.5 * glm::dvec3(m_grid.dims - 1);
}

double Field::normalised(double raw) const {
  return (raw - m_range.minimum) / (m_range.maximum - m_range.minimum);
}

std::array<float, 8> Field::rawCorners(const glm::ivec3& cell) const {
  const glm::ivec3& n = m_grid.dims;
  const std::size_t row = static_cast<std::size_t>(n.x);
  const std::size_t slice = row * static_cast<std::size_t>(n.y);
  const float* corner = m_raw.data() + cell.x + row * cell.y + slice * cell.z;
  const std::size_t dx = n.x > 1 ? 1 : 0;
  const std::size_t dy = n.y > 1 ? row : 0;
  const std::size_t dz = n.z > 1 ? slice : 0;
  return {corner[0],  corner[dx],      corner[dy],      corner[dx + dy],
          corner[dz], corner[dx + dz], corner[dy + dz], corner[dx + dy + dz]};
}

Corners Field::corners(const glm::ivec3& cell) const {
  const std::array<float, 8> raw = rawCorners(cell);
  Corners result;
  std::transform(raw.begin(), raw.end(), result.begin(), [this](float value) { return normalised(value); });
  return result;
}

double Field::maximumCorner(const glm::ivec3& cell) const {
  const std::array<float, 8> raw = rawCorners(cell);
  return normalised(*std::max_element(raw.begin(), raw.end()));
}

double Field::value(const glm::dvec3& voxel) const {
  const glm::dvec3 inside = glm::clamp(voxel, glm::dvec3(0), glm::dvec3(m_grid.dims - 1));
  const glm::ivec3 cell = glm::min(glm::ivec3(inside), glm::max(m_grid.dims - 2, glm::ivec3(0)));
  return std::clamp(trilinear(corners(cell), inside - glm::dvec3(cell)), 0.0, 1.0);
}

glm::dvec3 Field::gradient(const glm::dvec3& voxel) const {
  glm::dvec3 result(0);
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 low = voxel;
    glm::dvec3 high = voxel;
    low[axis] = std::clamp(voxel[axis] - 1, 0.0, m_grid.dims[axis] - 1.0);
    high[axis] = std::clamp(voxel[axis] + 1, 0.0, m_grid.dims[axis] - 1.0);
    const double distance = (high[axis] - low[axis]) * m_grid.spacingMm[axis];
    if (distance > 0) result[axis] = (value(high) - value(low)) / distance;
  }
  return result;
}

} // namespace volmark::reference
