// What every shader needs to know of a frame. One header for C++ and GLSL, scalar layout.
#ifndef VOLMARK_FRAME_CONSTANTS_H
#define VOLMARK_FRAME_CONSTANTS_H

#ifdef __cplusplus
#include <glm/glm.hpp>

#include <cstdint>
namespace volmark::gpu {
using glm::ivec2;
using glm::ivec3;
using glm::vec3;
using glm::vec4;
using uint = std::uint32_t;
#endif

const int kMaxViews = 4;
const int kMaxClippingPlanes = 6;

struct ViewConstants {
  vec3 position; // world
  vec3 right;
  vec3 up;
  vec3 forward;
  vec4 tangents; // left, right, down, up (signed)
};

struct FrameConstants {
  ViewConstants views[kMaxViews];
  vec4 clippingPlanes[kMaxClippingPlanes]; // xyz normal, w offset: keeps dot(normal, p) >= offset
  vec3 boxMinimum;                         // of voxel centres, world
  vec3 boxMaximum;
  vec3 spacing;
  ivec3 dims;
  ivec2 size; // of the output, pixels
  uint viewCount;
  uint clippingPlaneCount;
  float isovalue;   // normalised
  float valueScale; // sampled texel to normalised scalar
  float valueBias;
  float smallestSpacing; // length of "one voxel"
  vec4 light;            // world; w 0: towards it, w 1: its place
  vec3 lightColor;
  float ambient;
  uint headlight;
  uint shadingModel; // ShadingModel
  vec3 surfaceColor;
  uint frameIndex;
  uint seed;
};

#ifdef __cplusplus
static_assert(sizeof(ViewConstants) == 64);
static_assert(sizeof(FrameConstants) == 4 * 64 + 6 * 16 + 4 * 12 + 8 + 8 + 4 * 4 + 16 + 12 + 3 * 4 + 12 + 2 * 4);
} // namespace volmark::gpu
#endif

#endif
