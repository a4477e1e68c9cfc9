// What the host code and the shaders of ray marchers share. Scalar layout.
#ifndef PARTS_SHARED_H
#define PARTS_SHARED_H

#ifdef __cplusplus
#include <glm/glm.hpp>

#include <cstdint>
namespace volmark::parts {
using glm::ivec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using uint = std::uint32_t;
#endif

// Bindings of set 0.
const int kBindingFrame = 0;
const int kBindingVolume = 1;
const int kBindingColor = 2;
const int kBindingDistance = 3;
const int kBindingCounters = 4;
const int kBindingSteps = 5;
const int kBindingOwn = 6; // and following: the technique's. Surfaces: the image of normals; volumes: the table first

// Specialisation constants.
const int kIdShaderFiltering = 0;
const int kIdShadingModel = 1;
const int kIdJitter = 2;
const int kIdCounting = 3;
const int kIdEarlyTermination = 4; // volumes only
const int kIdOwn = 5;              // and following: the technique's

// Counters.
const int kCounterSamples = 0;
const int kCounterRays = 1;
const int kCounterEnded = 2; // hits of a surface, or rays ended by early termination
const int kCounterGradients = 3;
const int kCounterVisible = 4;       // volumes only: samples (slabs) with opacity
const int kCounterNodes = 5;         // of structures: questions whether a place is empty
const int kCounterShadowSamples = 6; // the same of rays from the light
const int kCounterShadowNodes = 7;
const int kCounterCount = 8;

// Depths of a texel of a shadow map: the components of a vec4.
const int kShadowDepths = 4;

// Pixels of a workgroup, each way.
const int kGroupSize = 8;

struct MarchConstants {
  float stepLength; // world units
  uint layers;      // output layer of view i in byte i
  uint bisections;  // surfaces only
  // Volumes only:
  float endTransmittance; // early termination at or below it
  float visibleLow;       // unclamped scalars at or below are transparent,
  float visibleHigh;      // and those at or above
  float tableScale;       // normalised scalar to table coordinate
  float tableBias;
  float visibleLowBeyond; // of what clipping planes cut off
  float visibleHighBeyond;
  // Of a shadow map, which is seen from the light:
  vec3 shadowRight;
  vec3 shadowUp;
  vec3 shadowForward;
  float shadowTangent; // from its middle to its sides
  float shadowBias;    // world units
  int shadowSize;      // texels along each side
  uvec4 hidden;        // segments, a bit each
  uint view;           // fragment shaders: the one that is drawn
};

// Ranges of voxels: bindings, specialisation constants.
const int kBindingVoxels = 0; // the volume; for parents: the level below
const int kBindingNodes = 1;  // what is written
const int kIdCooperative = 0; // a workgroup, instead of an invocation, makes a block
const int kRangeGroup = 4;    // invocations of a workgroup along each axis

struct MinMaxConstants {
  ivec3 dims;       // voxels
  ivec3 blockCells; // of a block, along each axis
  ivec3 blocks;     // beyond them nodes hold `nothing`
  ivec3 nodes;      // to be written
  vec2 nothing;     // a range that is neutral
};

#ifdef __cplusplus
static_assert(sizeof(MarchConstants) == 108);
static_assert(sizeof(MinMaxConstants) == 56);
} // namespace volmark::parts
#endif

#endif
