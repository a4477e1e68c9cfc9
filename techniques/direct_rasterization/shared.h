// What the host code and the shaders of this family share, beside parts/surface_shared.h. Scalar layout.
#ifndef DIRECT_RASTERIZATION_SHARED_H
#define DIRECT_RASTERIZATION_SHARED_H

#include <parts/surface_shared.h>

#ifdef __cplusplus
namespace volmark::direct_rasterization {
using glm::ivec3;
using glm::uvec2;
using parts::kIdSurfaceOwn;
using parts::kSurfaceOwn;
using uint = std::uint32_t;
#endif

// Bindings. Choosing blocks and regions:
const int kBindingBlocks = kSurfaceOwn;       // their sizes
const int kBindingRanges = kSurfaceOwn + 1;   // smallest and largest voxel of each block
const int kBindingPrevious = kSurfaceOwn + 2; // a word for each region: visible in the last frame
const int kBindingVisible = kSurfaceOwn + 3;  // and in this one
// Drawing them: kBindingBlocks, then
const int kBindingCounts = kSurfaceOwn + 1; // of the list that is drawn: the total
const int kBindingList = kSurfaceOwn + 2;   // blocks or regions
const int kBindingFlags = kSurfaceOwn + 3;  // of proxies: kBindingVisible

// Specialisation constants.
const int kIdBlockX = kIdSurfaceOwn; // cells of a block along each axis
const int kIdBlockY = kIdSurfaceOwn + 1;
const int kIdBlockZ = kIdSurfaceOwn + 2;
const int kIdChoice = kIdSurfaceOwn + 3; // of choose_blocks.comp.glsl

// What a block must be to be drawn.
const int kChooseOccupied = 0; // anything
const int kChoosePrevious = 1; // visible in the last frame
const int kChooseNew = 2;      // visible in this frame, not in the last one

// A workgroup of tasks has a block, one of meshes a list of its cells or, of proxies, as many regions.
const int kTaskThreads = 32;
const int kMaximumBlockCells = 256; // so that 8 bits name one
const int kMaximumListCells = 32;

// Counters.
const int kCountRegions = 0; // occupied
const int kCountBlocks = 1;  // drawn
const int kCountCells = 2;
const int kCountVertices = 3;
const int kCountTriangles = 4;
const int kCountLists = 5;
const int kCountProxies = 6;
const int kCounters = 7;

struct BlockConstants {
  ivec3 cells;  // of the volume
  ivec3 blocks; // along each axis
  ivec3 regions;
  ivec3 perRegion; // blocks of a region along each axis
  ivec3 regionCells;
  float grow; // of proxies, pixels: more than what rasterisers snap vertices by
};

struct DrawConstants {
  uint first;      // item of this draw
  uint totalIndex; // where the counts hold the number of items
};

#ifdef __cplusplus
static_assert(sizeof(BlockConstants) == 64);
static_assert(sizeof(DrawConstants) == 8);
} // namespace volmark::direct_rasterization
#endif

#endif
