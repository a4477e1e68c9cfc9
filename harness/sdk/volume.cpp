#include "volmark/volume.h"

#include "volmark/error.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

namespace volmark {

namespace {

constexpr std::array<std::string_view, 5> kTypeNames = {"int8", "uint8", "int16", "uint16", "float32"};

template <class T> double readAs(const std::byte* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

double readScalar(ScalarType type, const std::byte* bytes) {
  switch (type) {
  case ScalarType::int8: return readAs<std::int8_t>(bytes);
  case ScalarType::uint8: return readAs<std::uint8_t>(bytes);
  case ScalarType::int16: return readAs<std::int16_t>(bytes);
  case ScalarType::uint16: return readAs<std::uint16_t>(bytes);
  case ScalarType::float32: return readAs<float>(bytes);
  }
  return 0;
}

template <class T> Range rangeOf(std::span<const std::byte> bytes) {
  T low = std::numeric_limits<T>::max();
  T high = std::numeric_limits<T>::lowest();
  for (std::size_t i = 0; i + sizeof(T) <= bytes.size(); i += sizeof(T)) {
    T value;
    std::memcpy(&value, bytes.data() + i, sizeof(T));
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return {static_cast<double>(low), static_cast<double>(high)};
}

Range rangeOf(ScalarType type, std::span<const std::byte> bytes) {
  switch (type) {
  case ScalarType::int8: return rangeOf<std::int8_t>(bytes);
  case ScalarType::uint8: return rangeOf<std::uint8_t>(bytes);
  case ScalarType::int16: return rangeOf<std::int16_t>(bytes);
  case ScalarType::uint16: return rangeOf<std::uint16_t>(bytes);
  case ScalarType::float32: return rangeOf<float>(bytes);
  }
  return {};
}

void refuseNonFinite(const std::string& name, const Grid& grid, std::span<const std::byte> bytes) {
  for (std::size_t i = 0; i < bytes.size() / sizeof(float); ++i) {
    const double value = readAs<float>(bytes.data() + i * sizeof(float));
    if (std::isfinite(value)) continue;
    const std::size_t inStep = i % grid.voxelCount();
    const std::size_t x = inStep % grid.dims.x;
    const std::size_t y = inStep / grid.dims.x % grid.dims.y;
    const std::size_t z = inStep / grid.dims.x / grid.dims.y;
    throw InputError(fmt::format("{}: voxel ({}, {}, {}) is {}, allowed: finite numbers", name, x, y, z,
                                 std::isnan(value) ? "NaN" : "infinite"));
  }
}

std::string identityOf(const Grid& grid, ScalarType type, int timeSteps, std::span<const std::byte> bytes) {
  const std::string head = fmt::format("{} {} {} {} {:a} {:a} {:a} {}", nameOf(type), grid.dims.x, grid.dims.y,
                                       grid.dims.z, grid.spacingMm.x, grid.spacingMm.y, grid.spacingMm.z, timeSteps);
  XXH3_state_t* state = XXH3_createState();
  XXH3_128bits_reset(state);
  XXH3_128bits_update(state, head.data(), head.size());
  XXH3_128bits_update(state, bytes.data(), bytes.size());
  const XXH128_hash_t hash = XXH3_128bits_digest(state);
  XXH3_freeState(state);
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

} // namespace

std::size_t sizeOf(ScalarType type) {
  switch (type) {
  case ScalarType::int8:
  case ScalarType::uint8: return 1;
  case ScalarType::int16:
  case ScalarType::uint16: return 2;
  case ScalarType::float32: return 4;
  }
  return 0;
}

std::string_view nameOf(ScalarType type) {
  return kTypeNames.at(static_cast<std::size_t>(type));
}

ScalarType scalarTypeFromName(std::string_view name) {
  for (std::size_t i = 0; i < kTypeNames.size(); ++i)
    if (kTypeNames[i] == name) return static_cast<ScalarType>(i);
  throw InputError(fmt::format("scalar type: found \"{}\", allowed: {}", name, fmt::join(kTypeNames, ", ")));
}

std::size_t Grid::voxelCount() const {
  return static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(dims.z);
}

glm::dvec3 Grid::extentMm() const {
  return glm::dvec3(dims - 1) * spacingMm;
}

glm::dvec3 Grid::boxMinimum() const {
  return -0.5 * extentMm();
}

glm::dvec3 Grid::boxMaximum() const {
  return 0.5 * extentMm();
}

double Grid::boundingRadiusMm() const {
  return 0.5 * glm::length(extentMm());
}

double Grid::smallestSpacingMm() const {
  return std::min({spacingMm.x, spacingMm.y, spacingMm.z});
}

glm::dvec3 Grid::toVoxel(const glm::dvec3& world) const {
  return (world - boxMinimum()) / spacingMm;
}

glm::dvec3 Grid::toWorld(const glm::dvec3& voxel) const {
  return boxMinimum() + voxel * spacingMm;
}

Volume::Volume(std::string name, Grid grid, ScalarType type, SharedBytes shared, int timeSteps,
               std::vector<std::string> notes)
    : m_name(std::move(name)), m_grid(grid), m_type(type), m_timeSteps(timeSteps), m_bytes(std::move(shared)),
      m_notes(std::move(notes)) {
  const std::span<const std::byte> bytes = m_bytes.view();
  if (m_grid.dims.x < 1 || m_grid.dims.y < 1 || m_grid.dims.z < 1 || m_timeSteps < 1)
    throw InputError(fmt::format("{}: {} x {} x {} voxels, {} time steps: allowed are at least 1 of each", m_name,
                                 m_grid.dims.x, m_grid.dims.y, m_grid.dims.z, m_timeSteps));
  const std::size_t expected = m_grid.voxelCount() * sizeOf(m_type) * static_cast<std::size_t>(m_timeSteps);
  if (bytes.size() != expected)
    throw InputError(fmt::format("{}: {} bytes of voxels, expected {}", m_name, bytes.size(), expected));
  if (m_type == ScalarType::float32) refuseNonFinite(m_name, m_grid, bytes);
  m_dataRange = rangeOf(m_type, bytes);
  m_identity = identityOf(m_grid, m_type, m_timeSteps, bytes);
}

std::span<const std::byte> Volume::voxels(int timeStep) const {
  assert(timeStep >= 0 && timeStep < m_timeSteps);
  const std::size_t bytes = m_grid.voxelCount() * sizeOf(m_type);
  return m_bytes.view().subspan(bytes * static_cast<std::size_t>(timeStep), bytes);
}

Volume Volume::withLabels(std::shared_ptr<const Volume> labels) const {
  const glm::ivec3& dims = labels->grid().dims;
  if (dims != m_grid.dims || labels->timeSteps() != 1)
    throw InputError(fmt::format("{}: labels of {} x {} x {} voxels, {} time steps: allowed are {} x {} x {} and 1",
                                 labels->name(), dims.x, dims.y, dims.z, labels->timeSteps(), m_grid.dims.x,
                                 m_grid.dims.y, m_grid.dims.z));
  if (labels->type() != ScalarType::uint8 || labels->dataRange().maximum >= kMaximumSegments)
    throw InputError(fmt::format("{}: labels of type {} up to {}: allowed are uint8 and {}", labels->name(),
                                 nameOf(labels->type()), labels->dataRange().maximum, kMaximumSegments - 1));
  Volume result = *this;
  const std::string both = m_identity + labels->identity();
  const XXH128_hash_t hash = XXH3_128bits(both.data(), both.size());
  result.m_identity = fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
  result.m_labels = std::move(labels);
  return result;
}

double Volume::value(int i, int j, int k, int timeStep) const {
  assert(i >= 0 && j >= 0 && k >= 0 && i < m_grid.dims.x && j < m_grid.dims.y && k < m_grid.dims.z);
  const std::size_t index = (static_cast<std::size_t>(k) * m_grid.dims.y + j) * m_grid.dims.x + i;
  return readScalar(m_type, voxels(timeStep).data() + index * sizeOf(m_type));
}

} // namespace volmark
