// The scalar field in double precision: trilinear between voxel centres, normalised, clamped after interpolation.
#pragma once

#include "volmark/scene.h"

#include <array>
#include <vector>

namespace volmark::reference {

/// Values at a cell's corners; corner x + 2y + 4z. An axis of one voxel has both its corners at that voxel.
using Corners = std::array<double, 8>;

/// Trilinear interpolation at `local` in [0,1]^3.
double trilinear(const Corners& corners, const glm::dvec3& local);

/// One time step of a scene's volume. Positions are in voxels: [0, n-1] along each axis.
class Field {
public:
  Field(const Scene& scene, int timeStep);

  const glm::ivec3& dims() const { return m_grid.dims; }
  /// World units to voxels, for points and for directions.
  glm::dvec3 toVoxel(const glm::dvec3& world) const;
  glm::dvec3 directionToVoxel(const glm::dvec3& world) const { return world / m_grid.spacingMm; }

  /// Normalised, not clamped. `cell` is in [0, n-2] (0 along an axis of one voxel).
  Corners corners(const glm::ivec3& cell) const;
  /// The largest of the corners.
  double maximumCorner(const glm::ivec3& cell) const;

  /// Normalised and clamped; positions outside the box are moved to its surface.
  double value(const glm::dvec3& voxel) const;
  /// Central differences of value(), one voxel to either side, both ends moved into the box; per world unit. Zero along
  /// an axis of one voxel.
  glm::dvec3 gradient(const glm::dvec3& voxel) const;

private:
  std::array<float, 8> rawCorners(const glm::ivec3& cell) const;
  double normalised(double raw) const;

  Grid m_grid;
  Range m_range;
  std::vector<float> m_raw; // the data's own values: float holds every voxel type exactly
};

} // namespace volmark::reference
