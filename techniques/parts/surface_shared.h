// What the host code and the shaders of rasterising techniques share. Scalar layout.
#ifndef PARTS_SURFACE_SHARED_H
#define PARTS_SURFACE_SHARED_H

#ifdef __cplusplus
#include <glm/glm.hpp>

#include <cstdint>
namespace volmark::parts {
using glm::ivec3;
using glm::uvec3;
using glm::vec3;
using uint = std::uint32_t;
#endif

// Bindings of set 0.
const int kSurfaceFrame = 0;
const int kSurfaceVolume = 1;
const int kSurfaceLevel = 2;
const int kSurfaceTable = 3;
const int kSurfaceCounters = 4;
const int kSurfaceOwn = 5; // and following: the technique's

// Specialisation constants.
const int kIdSurfaceShadingModel = 0;
const int kIdSurfaceCounting = 1;
const int kIdSurfaceOwn = 2; // and following: the technique's

struct SurfaceConstants {
  float threshold; // a texel at or above it is inside; the one test of everything
  float texel;     // the isovalue as a texel value, where edges are cut; within rounding of the threshold
  float near;      // distance of the near plane, world units
  uint layers;     // output layer of view i in byte i
};

// Of an edge, at both of its ends: no vertex lies there. Coordinates below 2048 tell it from the voxel.
const float kEdgeMargin = 1.0f / 4096;

// Choosing items out of a list, in order: count, scan, write.
const int kCompactGroup = 256;    // items of a workgroup
const int kScanGroup = 256;       // invocations of the one workgroup that scans
const int kDispatchWidth = 32768; // workgroups along x; the rest lie along y

const uint kNoIndex = 0xffffffffu;

struct CompactConstants {
  uint items;
};

// Of the scan: sums of counts. Draws of at most `chunk` items each.
struct ScanConstants {
  uint groups;     // how many counts, unless `sizeIndex` says where that stands
  uint sizeIndex;  // in the buffer of sizes, or kNoIndex
  uint totalIndex; // where the total goes, behind the counts
  uint chunk;      // items of a draw
  uint draws;      // arguments to be written
  uint perTask;    // items of a task (or mesh) workgroup
};

#ifdef __cplusplus
static_assert(sizeof(SurfaceConstants) == 16);
static_assert(sizeof(ScanConstants) == 24);
} // namespace volmark::parts
#endif

#endif
