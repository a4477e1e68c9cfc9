// One axis of a distance transform. The minimum over all occupied texels splits into one minimum an axis:
// EUCLIDEAN: of the squared distances of boxes, per axis max(|d| - 1, 0) squared, added up;
// CHEBYSHEV: of the number of texels to go, one way along each axis, the largest counts.
// Macros: EUCLIDEAN or CHEBYSHEV; LAST for the axis after which rays read the result.
// One invocation is one texel. It runs for x, y and z, with a barrier in between; then rays read the result.
#version 460

#extension GL_EXT_scalar_block_layout : require

#include <empty_space_skipping/shared.h>

layout(local_size_x = kRangeGroup, local_size_y = kRangeGroup, local_size_z = kRangeGroup) in;

layout(set = 0, binding = kBindingBefore, scalar) readonly buffer Before {
  uint before[];
};
#ifdef LAST
layout(set = 0, binding = kBindingAfter, r8ui) uniform writeonly uimage3D distances;
#else
layout(set = 0, binding = kBindingAfter, scalar) writeonly buffer After {
  uint after[];
};
#endif
layout(set = 0, binding = kBindingOccupied, scalar) readonly buffer Occupied {
  uint occupied[];
};
layout(push_constant, scalar) uniform DistanceBlock {
  DistanceConstants transform;
};

const uint kFar = 0x3fffffffu;
// The largest stored value is 255; further away nothing has to be looked for.
const int kLargest = 255;

int indexOf(ivec3 texel) {
  return (texel.z * transform.texels.y + texel.y) * transform.texels.x + texel.x;
}

uint distanceBefore(int index) {
  uint value = before[index];
  if (transform.first == 0) return value;
  return value != 0u ? 0u : kFar;
}

// The largest integer whose square is at most `value` < 2^30.
uint rootOf(uint value) {
  uint root = uint(sqrt(float(value)));
  if (root * root > value) --root;
  if ((root + 1u) * (root + 1u) <= value) ++root;
  return root;
}

// What rays read of an empty texel (distance.glsl).
uint storedDistance(uint best) {
#ifdef EUCLIDEAN
  // Boxes that touch have distance 0.
  uint farthest = uint(kLargest - 1);
  if (best > farthest * farthest) return uint(kLargest);
  return 1u + min(rootOf(uint(transform.blockEdge * transform.blockEdge) * best), farthest);
#else
  return min(best, uint(kLargest));
#endif
}

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(texel, transform.texels))) return;
  int here = indexOf(texel);
  int stride = transform.axis == 0 ? 1 : transform.axis == 1 ? transform.texels.x
                                                             : transform.texels.x * transform.texels.y;
  int place = texel[transform.axis];
  int size = transform.texels[transform.axis];
  uint best = distanceBefore(here);
#ifdef EUCLIDEAN
  for (int d = 1; d < size; ++d) {
    uint gap = uint(d - 1);
    // Nothing further away can be nearer, or is small enough to be told from far.
    if (gap * gap >= best || int(gap) * transform.blockEdge > kLargest) break;
    if (place - d >= 0) best = min(best, distanceBefore(here - d * stride) + gap * gap);
    if (place + d < size) best = min(best, distanceBefore(here + d * stride) + gap * gap);
  }
#else
  for (int d = 1; d <= kLargest && uint(d) < best; ++d) {
    int there = place + d * transform.direction;
    if (there < 0 || there >= size) break;
    best = min(best, max(distanceBefore(here + d * transform.direction * stride), uint(d)));
  }
#endif
#ifdef LAST
  ivec3 written = texel + ivec3(0, 0, transform.firstSlice);
  imageStore(distances, written, uvec4(occupied[here] != 0u ? 0u : storedDistance(best)));
#else
  after[here] = best;
#endif
}
