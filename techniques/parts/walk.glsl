// A ray on its way through blocks of voxels. Samples are those of the path (parts/march.glsl), by index.
#ifndef PARTS_WALK_GLSL
#define PARTS_WALK_GLSL

#include <parts/march.glsl>

struct Walk {
  vec3 base;      // voxel coordinates of place 0: cell c spans c to c + 1 (a voxel, if blocks hold voxels)
  vec3 delta;     // and of a step
  vec3 inverse;   // 1 / delta, huge where the ray stands still
  ivec3 ahead;    // 1 along axes that a box is left by at its high side
  ivec3 lastCell;
  float shift;
  float places;
  int end;        // of the indices
  int level;      // octrees: where the next search starts
  uint nodes;     // questions asked
};

// `shift`: place of sample 0; `end`: of the indices; `voxelBlocks`: blocks hold voxels instead of cells; `level`: where an
// octree's first search starts.
Walk makeWalk(VolumeGrid grid, Path path, float shift, int end, bool voxelBlocks, int level) {
  Walk walk;
  vec3 voxels = kShaderFiltering ? vec3(1) : vec3(grid.dims);
  walk.base = path.base * voxels - (kShaderFiltering ? 0.0 : 0.5) + (voxelBlocks ? 0.5 : 0.0);
  walk.delta = path.delta * voxels;
  bvec3 still = lessThan(abs(walk.delta), vec3(1e-20));
  walk.inverse = mix(1.0 / walk.delta, vec3(1e30), still);
  walk.ahead = ivec3(not(lessThan(walk.delta, vec3(0))));
  walk.lastCell = max(grid.dims - (voxelBlocks ? 1 : 2), ivec3(0));
  walk.shift = shift;
  walk.places = path.places;
  walk.end = end;
  walk.level = level;
  walk.nodes = 0u;
  return walk;
}

// The cell of a sample. One function of the index for all questions, so that what lies between two samples in a box
// is in it, too.
ivec3 cellAt(Walk walk, int index) {
  precise float place = min(walk.shift + float(index), walk.places);
  precise vec3 voxel = walk.base + place * walk.delta;
  return clamp(ivec3(floor(voxel)), ivec3(0), walk.lastCell);
}

// Index of a sample from `index` on, itself in the box of cells low to high (inclusive), up to which all are in the box:
// the last one but for rounding, which never makes it one too many.
int lastInside(Walk walk, ivec3 low, ivec3 high, int index) {
  vec3 sides = mix(vec3(low), vec3(high + 1), bvec3(walk.ahead));
  vec3 exits = (sides - walk.base) * walk.inverse;
  float exit = min(min(exits.x, exits.y), min(exits.z, walk.places + 1.0));
  // A little less than the exit, so that the check seldom fails.
  int last = clamp(int(floor(exit - walk.shift - 1e-3)), index, walk.end - 1);
  bvec3 outside = greaterThan(uvec3(cellAt(walk, last) - low), uvec3(high - low));
  return any(outside) ? index : last;
}

#endif
