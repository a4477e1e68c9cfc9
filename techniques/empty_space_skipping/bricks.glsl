// The next brick with something visible, by ray queries against boxes of bricks in voxel space.
#ifndef EMPTY_SPACE_SKIPPING_BRICKS_GLSL
#define EMPTY_SPACE_SKIPPING_BRICKS_GLSL

#extension GL_EXT_ray_query : require

#include <empty_space_skipping/walk.glsl>

layout(set = 0, binding = kBindingStructure) uniform accelerationStructureEXT tree;
layout(set = 0, binding = kBindingBoxes, scalar) readonly buffer Boxes {
  BrickBox boxes[]; // of primitive i
};

// Where the ray from `origin` along a step enters a box, in steps; negative inside, huge if it misses.
float entryOf(Walk walk, vec3 origin, BrickBox box) {
  vec3 a = (box.low - origin) * walk.inverse;
  vec3 b = (box.high - origin) * walk.inverse;
  vec3 near = min(a, b);
  vec3 far = max(a, b);
  float entry = max(near.x, max(near.y, near.z));
  float exit = min(far.x, min(far.y, far.z));
  return entry <= exit && exit >= 0.0 ? entry : 3.402823466e38;
}

// True if sample `index` is transparent, and all up to `last`; if not, those up to `last` are in the same brick.
bool findEmpty(Classification by, inout Walk walk, int index, out int last) {
  float place = min(walk.shift + float(index), walk.places);
  vec3 origin = walk.base + place * walk.delta;
  float farthest = max(walk.places - place, 0.0) + 1.0;
  float nearest = farthest;
  int brick = -1;
  rayQueryEXT query;
  rayQueryInitializeEXT(query, tree, gl_RayFlagsNoneEXT, 0xffu, origin, 0.0, walk.delta, farthest);
  while (rayQueryProceedEXT(query)) {
    int candidate = rayQueryGetIntersectionPrimitiveIndexEXT(query, false);
    float entry = max(entryOf(walk, origin, boxes[candidate]), 0.0);
    if (entry < nearest) {
      nearest = entry;
      brick = candidate;
      rayQueryGenerateIntersectionEXT(query, entry);
    }
  }
  ++walk.nodes;
  if (brick < 0) {
    last = walk.end - 1;
    return true;
  }
  // Boxes are larger than bricks by more than what rounding moves samples.
  int empty = int(ceil(min(nearest, 1e9) - 1e-3));
  if (empty > 0) {
    last = min(index + empty - 1, walk.end - 1);
    return true;
  }
  ivec3 low = (ivec3(round(boxes[brick].low + 0.5 * kBoxMargin)) >> skipping.blockShift) << skipping.blockShift;
  ivec3 high = low + (1 << skipping.blockShift) - 1;
  ivec3 cell = cellAt(walk, index);
  bool inside = all(greaterThanEqual(cell, low)) && all(lessThanEqual(cell, high));
  last = inside ? lastInside(walk, low, high, index) : index;
  return false;
}

#endif
