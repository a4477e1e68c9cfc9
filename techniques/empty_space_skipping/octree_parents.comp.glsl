// One level of an octree from the level below: OR of eight children, or their range (Faludi et al. 2021, section 3.3).
// Macros: NODE_FORMAT, the image's format; MINMAX, or not.
// One invocation is one node. The next level runs next.
#version 460

#extension GL_EXT_scalar_block_layout : require

#include <empty_space_skipping/shared.h>

layout(local_size_x = kBuildGroup, local_size_y = kBuildGroup, local_size_z = kBuildGroup) in;

#ifdef MINMAX
layout(set = 0, binding = kBindingVoxels) uniform sampler3D children;
layout(set = 0, binding = kBindingNodes, NODE_FORMAT) uniform writeonly image3D nodes;
#else
layout(set = 0, binding = kBindingVoxels) uniform usampler3D children;
layout(set = 0, binding = kBindingNodes, NODE_FORMAT) uniform writeonly uimage3D nodes;
#endif
layout(push_constant, scalar) uniform BuildBlock {
  BuildConstants build;
};

void main() {
  ivec3 node = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(node, build.nodes))) return;
#ifdef MINMAX
  vec2 range = texelFetch(children, 2 * node, 0).xy;
#else
  uvec4 bits = uvec4(0);
#endif
  for (int child = 0; child < 8; ++child) {
    ivec3 place = 2 * node + ivec3(child & 1, (child >> 1) & 1, child >> 2);
#ifdef MINMAX
    vec2 other = texelFetch(children, place, 0).xy;
    range = vec2(min(range.x, other.x), max(range.y, other.y));
#else
    bits |= texelFetch(children, place, 0);
#endif
  }
#ifdef MINMAX
  imageStore(nodes, node, vec4(range, 0, 0));
#else
  imageStore(nodes, node, bits);
#endif
}
