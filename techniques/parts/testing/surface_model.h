// A plain CPU model of what surface extraction must find: counts, list cuts, and a welded mesh.
#pragma once

#include "volmark/scene.h"
#include "volmark/surface_mesh.h"

#include <cstdint>
#include <vector>

namespace volmark::parts {

struct SurfaceCounts {
  std::uint64_t blocks = 0; ///< with a cell that is occupied
  std::uint64_t cells = 0;
  std::uint64_t vertices = 0; ///< indexed within each cell
  std::uint64_t triangles = 0;
  std::uint64_t lists = 0;
};

/// Of one time step; blocks of `block` cells, lists of at most `vertexLimit` vertices and 32 cells.
SurfaceCounts countSurface(const Scene& scene, double isovalue, const glm::ivec3& block, int vertexLimit,
                           int timeStep = 0);

/// Vertices shared by all cells around an edge, without normals.
SurfaceMesh modelSurface(const Scene& scene, double isovalue, int timeStep = 0);

/// Vertices with the same bits become one; triangles of two equal corners go.
SurfaceMesh weldByPosition(const SurfaceMesh& mesh);

/// What makes a mesh a closed, oriented surface.
struct Topology {
  std::uint64_t openSides = 0;          ///< directed sides of triangles that are not there as often the other way round
  std::int64_t eulerCharacteristic = 0; ///< vertices - edges + triangles
  double volume = 0;                    ///< enclosed; negative if it is turned inside out
};
Topology topologyOf(const SurfaceMesh& mesh);

} // namespace volmark::parts
