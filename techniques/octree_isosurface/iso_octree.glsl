// Isosurface by ray marching that skips nodes of a min-max octree: the reference of Kreskowski et al. 2022 (direct isosurface
// rasterization), section 4. The samples are those of iso_raymarch; none that is inside is skipped.
// Macro: FRAGMENT, in a fragment shader drawn over the whole picture; a compute shader otherwise, in workgroups of 8 x 8.
// One invocation is one pixel of one view; nothing runs after it.
#version 460

#include <octree_isosurface/shared.h>
#include <parts/walk.glsl>

layout(constant_id = kIdBidirectional) const bool kBidirectional = true;

layout(set = 0, binding = kBindingConstants, scalar) uniform OctreeBlock {
  OctreeConstants tree;
};
layout(set = 0, binding = kBindingOctree) uniform sampler3D octree;

// Whether all samples in a node are outside. A ray that meets a node without outside has hit, so that the smallest voxel
// does not matter.
bool isEmpty(float surface, ivec3 node, int level) {
  return texelFetch(octree, node, level).y < surface - tree.margin;
}

#define QUESTION float
#include <parts/octree.glsl>

Walk makeWalk(VolumeGrid grid, Path path, float shift, int end) {
  return makeWalk(grid, path, shift, end, false, tree.initialLevel);
}

bool findEmpty(float surface, inout Walk walk, int index, out int last) {
  return findEmptyNode(surface, tree.blockShift, tree.initialLevel, kBidirectional, walk, index, last);
}

#define SKIPPING
#include <parts/isosurface_march.glsl>
#include <parts/isosurface_pixel.glsl>
