// Marks the region of a proxy as visible. One invocation is a fragment that nothing drawn so far hides. choose_blocks.comp.glsl
// runs next.
#version 460

#extension GL_EXT_scalar_block_layout : require

#include <direct_rasterization/shared.h>

layout(early_fragment_tests) in;

layout(set = 0, binding = kBindingFlags, scalar) writeonly buffer FlagsBlock {
  uint isVisible[];
};
layout(location = 0) in flat uint region;

void main() {
  isVisible[region] = 1u;
}
