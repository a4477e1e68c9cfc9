// A volume in host memory: the data's own scalar type, native byte order, x fastest.
#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace volmark {

enum class ScalarType : std::uint8_t { int8, uint8, int16, uint16, float32 };

/// Bytes of one scalar: 1, 2 or 4.
std::size_t sizeOf(ScalarType type);
/// "int8", "uint8", "int16", "uint16" or "float32".
std::string_view nameOf(ScalarType type);
/// The inverse of nameOf. Throws InputError naming the allowed types.
ScalarType scalarTypeFromName(std::string_view name);

/// The shape of a volume's grid. World space: right-handed, y up, millimetres, the volume's centre at the
/// origin. n voxels along an axis span (n-1)*spacing: the box of voxel centres (harness/README.md,
/// Conventions).
struct Grid {
  glm::ivec3 dims{1};        ///< voxels along x, y, z; each at least 1
  glm::dvec3 spacingMm{1.0}; ///< distance of voxel centres, > 0

  std::size_t voxelCount() const;
  glm::dvec3 extentMm() const;                       ///< (dims-1)*spacing; 0 along an axis of one voxel
  glm::dvec3 boxMinimum() const;                     ///< -extent/2
  glm::dvec3 boxMaximum() const;                     ///< +extent/2
  double boundingRadiusMm() const;                   ///< half the box's diagonal
  double smallestSpacingMm() const;                  ///< the length that "one voxel" means for steps and opacity
  glm::dvec3 toVoxel(const glm::dvec3& world) const; ///< continuous voxel coordinates, [0, n-1] inside the box
  glm::dvec3 toWorld(const glm::dvec3& voxel) const;
};

struct Range {
  double minimum = 0;
  double maximum = 1;
};

/// Bytes in memory or in a mapped file, for as long as a copy of this lives.
class SharedBytes {
public:
  SharedBytes(std::vector<std::byte> bytes) {
    auto owner = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
    m_view = *owner;
    m_owner = std::move(owner);
  }
  SharedBytes(std::shared_ptr<const void> owner, std::span<const std::byte> view)
      : m_owner(std::move(owner)), m_view(view) {}

  std::span<const std::byte> view() const { return m_view; }

private:
  std::shared_ptr<const void> m_owner;
  std::span<const std::byte> m_view;
};

/// Labels of segments are below this.
inline constexpr int kMaximumSegments = 128;

/// Immutable after construction, shared between threads. Voxels of float32 volumes are finite.
class Volume {
public:
  /// `bytes`: timeSteps * voxelCount * sizeOf(type) bytes. Scans for the range and, in float32 data, for NaN
  /// and infinity. `notes`: what whoever looks at the volume should know about how it was read, a sentence each.
  /// Throws InputError (prefixed with `name`) on a wrong size or a value that isn't finite.
  Volume(std::string name, Grid grid, ScalarType type, SharedBytes bytes, int timeSteps = 1,
         std::vector<std::string> notes = {});

  const std::string& name() const { return m_name; }
  const Grid& grid() const { return m_grid; }
  ScalarType type() const { return m_type; }
  int timeSteps() const { return m_timeSteps; }
  /// Smallest and largest voxel over all time steps, in the data's unit.
  Range dataRange() const { return m_dataRange; }
  /// Hex XXH3-128 of type, dims, spacing, time steps, voxels and labels: the data's identity in results.
  const std::string& identity() const { return m_identity; }
  const std::vector<std::string>& notes() const { return m_notes; }
  /// Which segment each voxel belongs to: uint8 of the same dims, below kMaximumSegments; null if there are none.
  const std::shared_ptr<const Volume>& labels() const { return m_labels; }

  /// One time step: voxelCount * sizeOf(type) bytes.
  std::span<const std::byte> voxels(int timeStep = 0) const;
  /// One voxel in the data's unit. Indices must be inside.
  double value(int i, int j, int k, int timeStep = 0) const;

  /// The same voxels with labels. Throws InputError if `labels` is no such volume.
  Volume withLabels(std::shared_ptr<const Volume> labels) const;

private:
  std::string m_name;
  Grid m_grid;
  ScalarType m_type;
  int m_timeSteps;
  SharedBytes m_bytes;
  std::vector<std::string> m_notes;
  Range m_dataRange;
  std::string m_identity;
  std::shared_ptr<const Volume> m_labels;
};

} // namespace volmark
