// The corners of a region, and how far from a view they are.
#ifndef DIRECT_RASTERIZATION_REGION_BOX_GLSL
#define DIRECT_RASTERIZATION_REGION_BOX_GLSL

#include <direct_rasterization/blocks.glsl>

// Regions nearer than this many near distances get no proxy: rounding can't push one through the near plane.
const float kNearSlack = 1.1;

vec3 regionCorner(ivec3 region, int corner) {
  ivec3 place = region + ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
  precise vec3 world = frame.boxMinimum + vec3(min(place * grid.regionCells, grid.cells)) * frame.spacing;
  return world;
}

// Smallest and largest distance along the view direction.
vec2 distancesOfRegion(ivec3 region, ViewConstants view) {
  vec2 range = vec2(3.402823466e38, -3.402823466e38);
  for (int corner = 0; corner < 8; ++corner) {
    float distance = distanceAlongView(view, regionCorner(region, corner));
    range = vec2(min(range.x, distance), max(range.y, distance));
  }
  return range;
}

#endif
