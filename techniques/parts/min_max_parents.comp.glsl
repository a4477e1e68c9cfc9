// One level of a min-max octree from the level below: the range of eight children.
// Macro: NODE_FORMAT, the image's format.
// One invocation is one node. The next level runs next.
#version 460

#extension GL_EXT_scalar_block_layout : require

#include <parts/shared.h>

layout(local_size_x = kRangeGroup, local_size_y = kRangeGroup, local_size_z = kRangeGroup) in;

layout(set = 0, binding = kBindingVoxels) uniform sampler3D children;
layout(set = 0, binding = kBindingNodes, NODE_FORMAT) uniform writeonly image3D nodes;
layout(push_constant, scalar) uniform MinMaxBlock {
  MinMaxConstants build;
};

void main() {
  ivec3 node = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(node, build.nodes))) return;
  vec2 range = build.nothing;
  for (int child = 0; child < 8; ++child) {
    vec2 other = texelFetch(children, 2 * node + ivec3(child & 1, (child >> 1) & 1, child >> 2), 0).xy;
    range = vec2(min(range.x, other.x), max(range.y, other.y));
  }
  imageStore(nodes, node, vec4(range, 0, 0));
}
