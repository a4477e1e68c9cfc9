// One level of an octree from the level below: OR of eight children (Faludi et al. 2021, section 3.3).
// Macro: NODE_FORMAT, the image's format.
// One invocation is one node. The next level runs next.
#version 460

#extension GL_EXT_scalar_block_layout : require

#include <empty_space_skipping/shared.h>

layout(local_size_x = kRangeGroup, local_size_y = kRangeGroup, local_size_z = kRangeGroup) in;

layout(set = 0, binding = kBindingVoxels) uniform usampler3D children;
layout(set = 0, binding = kBindingNodes, NODE_FORMAT) uniform writeonly uimage3D nodes;
layout(push_constant, scalar) uniform BuildBlock {
  BuildConstants build;
};

void main() {
  ivec3 node = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(node, build.nodes))) return;
  uvec4 bits = uvec4(0);
  for (int child = 0; child < 8; ++child) {
    ivec3 place = 2 * node + ivec3(child & 1, (child >> 1) & 1, child >> 2);
    bits |= texelFetch(children, place, 0);
  }
  imageStore(nodes, node, bits);
}
