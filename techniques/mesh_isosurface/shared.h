// What the host code and the shaders of this family share, beside parts/surface_shared.h. Scalar layout.
#ifndef MESH_ISOSURFACE_SHARED_H
#define MESH_ISOSURFACE_SHARED_H

#include <parts/surface_shared.h>

#ifdef __cplusplus
namespace volmark::mesh_isosurface {
using glm::ivec3;
using glm::uvec2;
using glm::vec3;
using parts::kSurfaceOwn;
using uint = std::uint32_t;
#endif

// Cells of a block along each axis: vertices are shared within a block.
const int kBlockEdge = 8;
const int kExtractThreads = kBlockEdge * kBlockEdge; // of a workgroup, which works on one block: one a row of cells
// A block's inside voxels, as what counts leaves them for what writes: bits of rows.
const int kRowsInWord = 3;
const int kRowWords = (kBlockEdge + 1) * (kBlockEdge + 1) / kRowsInWord;

// Bindings. Choosing blocks: the sizes, the ranges, then those of parts/compact.glsl. Extraction:
const int kBindingBlocks = kSurfaceOwn; // sizes
const int kBindingRanges = kSurfaceOwn + 1;
const int kBindingChosen = kSurfaceOwn + 1;       // counts of the choice, for the total
const int kBindingList = kSurfaceOwn + 2;         // occupied blocks
const int kBindingVertexCounts = kSurfaceOwn + 3; // of each of them; sums before it after the scan
const int kBindingTriangleCounts = kSurfaceOwn + 4;
// Meshlets:
const int kBindingMeshlets = kSurfaceOwn;
const int kBindingMeshletVertices = kSurfaceOwn + 1;
const int kBindingMeshletTriangles = kSurfaceOwn + 2;

struct BlockConstants {
  ivec3 cells;  // of the volume
  ivec3 blocks; // along each axis
};

struct Vertex {
  vec3 position; // world
  vec3 normal;   // unit, or 0
};

// Addresses of buffers, which may be larger than a storage binding.
struct ExtractConstants {
  uvec2 vertices;
  uvec2 indices;
  uvec2 rows;
  uint rowBlocks;  // that there is room for in rows
  uint totalIndex; // where the counts of the choice hold the number of blocks
};

struct MeshConstants {
  uvec2 vertices;
  uint meshlets;
};

const int kMeshletVertices = 64;
const int kMeshletTriangles = 124;
const int kMeshletThreads = 32;

struct Meshlet {
  uint firstVertex;   // in the list of vertices
  uint firstTriangle; // in the list of triangles
  uint vertices;
  uint triangles;
};

#ifdef __cplusplus
static_assert(sizeof(BlockConstants) == 24);
static_assert(sizeof(Vertex) == 24);
static_assert(sizeof(ExtractConstants) == 32);
static_assert(sizeof(MeshConstants) == 12);
static_assert(sizeof(Meshlet) == 16);
} // namespace volmark::mesh_isosurface
#endif

#endif
