// A mesh made ready for drawing, on the host, by meshoptimizer.
#pragma once

#include "shared.h"
#include "volmark/surface_mesh.h"

#include <vector>

namespace volmark::mesh_isosurface {

struct OptimizedMesh {
  std::vector<Vertex> vertices;       ///< none twice; in the order of their use
  std::vector<std::uint32_t> indices; ///< three a triangle, for vertex caches and little overdraw
  std::vector<Meshlet> meshlets;
  std::vector<std::uint32_t> meshletVertices;
  std::vector<std::uint32_t> meshletTriangles; ///< three bytes each
};

/// Vertices of equal bits become one, triangles without area by that go.
OptimizedMesh optimize(const SurfaceMesh& mesh, bool withMeshlets);

} // namespace volmark::mesh_isosurface
