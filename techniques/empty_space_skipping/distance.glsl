// Leaps over empty space by stored distances. Values: 0 is an occupied texel.
// EUCLIDEAN: otherwise 1 + the distance of the texel's box to the nearest occupied one in voxels, rounded down.
// CHEBYSHEV: otherwise n: the cube of n texels from here on in the ray's octant is empty (Es and Isler 2007). Octant o has
// the slices from o * texels.z on.
#ifndef EMPTY_SPACE_SKIPPING_DISTANCE_GLSL
#define EMPTY_SPACE_SKIPPING_DISTANCE_GLSL

#include <empty_space_skipping/walk.glsl>

layout(set = 0, binding = kBindingStructure) uniform usampler3D distances;

// True if sample `index` is transparent, and all up to `last`; if not, those up to `last` are in the same texel.
bool findEmpty(Classification by, inout Walk walk, int index, out int last) {
  int shift = skipping.blockShift;
  ivec3 texel = cellAt(walk, index) >> shift;
  ++walk.nodes;
#ifdef CHEBYSHEV
  int octant = walk.ahead.x + 2 * walk.ahead.y + 4 * walk.ahead.z;
  int slices = (walk.lastCell.z >> shift) + 1;
  int distance = int(texelFetch(distances, texel + ivec3(0, 0, octant * slices), 0).x);
  ivec3 reach = ivec3(max(distance - 1, 0));
  ivec3 low = texel - reach * (1 - walk.ahead);
  ivec3 high = texel + reach * walk.ahead;
  last = lastInside(walk, low << shift, ((high + 1) << shift) - 1, index);
#else
  int distance = int(texelFetch(distances, texel, 0).x);
  ivec3 low = texel << shift;
  last = lastInside(walk, low, low + (1 << shift) - 1, index);
  if (distance > 1) {
    // A sample nearer than that distance lies in no occupied texel. One part in a million is rounding's.
    float steps = float(distance - 1) / length(walk.delta) * 0.999999;
    last = max(last, min(index + int(min(steps, 1e9)), walk.end - 1));
  }
#endif
  return distance > 0;
}

#endif
