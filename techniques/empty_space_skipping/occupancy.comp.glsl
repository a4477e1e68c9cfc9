// Which texels of a distance map are occupied: those with a cell that the transfer function can show.
// One invocation (one workgroup, if cooperative) is one texel. distance.comp.glsl runs next.
#version 460

#include <empty_space_skipping/block.glsl>
#include <empty_space_skipping/visible.glsl>

layout(set = 0, binding = kBindingNodes, scalar) writeonly buffer Occupancy {
  uint occupied[]; // 1 or 0
};

void main() {
  ivec3 texel = blockOfInvocation();
  vec2 range = rangeOfBlock(texel);
  if (any(greaterThanEqual(texel, build.blocks)) || (kCooperative && gl_LocalInvocationIndex != 0u)) return;
  bool shows = showsBetween(scalarOf(range.x), scalarOf(range.y), build.tableEntries);
  occupied[(texel.z * build.blocks.y + texel.y) * build.blocks.x + texel.x] = shows ? 1u : 0u;
}
