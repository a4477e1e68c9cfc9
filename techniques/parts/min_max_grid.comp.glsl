// Smallest and largest voxel of blocks of cells: those of k cells have k + 1 voxels along an axis, so that a surface through
// a cell is in the range of its block.
// Macro: NODE_FORMAT, the image's format.
// One invocation (one workgroup, if cooperative) is one block. min_max_parents.comp.glsl runs next, or nothing.
#version 460

#extension GL_EXT_scalar_block_layout : require

#include <parts/voxel_range.glsl>

layout(set = 0, binding = kBindingNodes, NODE_FORMAT) uniform writeonly image3D nodes;
layout(push_constant, scalar) uniform MinMaxBlock {
  MinMaxConstants build;
};

void main() {
  ivec3 node = blockOfInvocation();
  ivec3 low = node * build.blockCells;
  vec2 range = rangeOf(low, min(low + build.blockCells, build.dims - 1));
  if (any(greaterThanEqual(node, build.nodes)) || (kCooperative && gl_LocalInvocationIndex != 0u)) return;
  // Padding is neutral to its parent.
  bool isBlock = all(lessThan(node, build.blocks));
  imageStore(nodes, node, vec4(isBlock ? range : build.nothing, 0, 0));
}
