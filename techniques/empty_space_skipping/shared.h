// What the host code and the shaders of this family share, beside parts/shared.h. Scalar layout.
#ifndef EMPTY_SPACE_SKIPPING_SHARED_H
#define EMPTY_SPACE_SKIPPING_SHARED_H

#include <parts/shared.h>

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace volmark::empty_space_skipping {
using glm::ivec3;
using glm::uvec4;
using glm::vec3;
using uint = std::uint32_t;
using parts::kBindingOwn;
using parts::kIdCooperative;
using parts::kIdOwn;
#endif

// Drawing: bindings after the table, specialisation constants.
const int kBindingSkipping = kBindingOwn + 1;
const int kBindingStructure = kBindingOwn + 2;
const int kBindingBoxes = kBindingStructure + 1; // of bricks alone
const int kIdBidirectional = kIdOwn;             // octrees: go on at the level of the last question
const int kIdVoxelBlocks = kIdOwn + 1;           // blocks hold voxels (the paper) instead of cells
const int kIdSharedSlabs = kIdOwn + 2;           // pre-integration: a slab between two empty nodes can't show

struct SkippingConstants {
  uvec4 mask;       // bitfield octree: bins that the transfer function shows
  uvec4 maskBeyond; // the same of what clipping planes cut off
  uvec4 shown;      // segments that are not hidden
  int blockShift;   // log2 of the voxels along a leaf's (texel's) edge
  int initialLevel; // octrees: highest level asked; 0 are the leaves
};

// A brick's cells in voxel coordinates, larger by a margin on each side. As VkAabbPositionsKHR.
const float kBoxMargin = 0.01f;
struct BrickBox {
  vec3 low;
  vec3 high;
};

// Building: bindings, beside kBindingVoxels and kBindingNodes.
const int kBindingVisible = 2; // prefix sums over the table's entries that show

struct BuildConstants {
  ivec3 dims;        // voxels
  int blockEdge;     // voxels
  ivec3 blocks;      // along each axis; beyond them nodes are neutral
  int tableEntries;  // of the transfer function
  ivec3 nodes;       // to be written
  float rawScale;    // sampled texel to stored integer; 0: floats
  float scalarScale; // raw value (integer or float) to normalised scalar
  float scalarBias;
  int bits;        // of a bitfield
  int voxelBlocks; // 1: a block's own voxels; 0: those of its cells, one more along each axis
};

// Distances: along an axis, towards an end.
const int kBindingBefore = 0;
const int kBindingAfter = 1;
const int kBindingOccupied = 2;

struct DistanceConstants {
  ivec3 texels;
  int axis;
  int direction;  // Chebyshev: +1 or -1
  int first;      // 1: `before` holds occupancy instead of distances
  int firstSlice; // of the image, where this octant's texels are written
  int blockEdge;  // voxels of a texel
};

#ifdef __cplusplus
static_assert(sizeof(SkippingConstants) == 56);
static_assert(sizeof(BrickBox) == 24);
static_assert(sizeof(BuildConstants) == 64);
static_assert(sizeof(DistanceConstants) == 32);
} // namespace volmark::empty_space_skipping
#endif

#endif
