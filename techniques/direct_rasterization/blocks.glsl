// Blocks of cells and the regions that hold them, for what chooses them.
#ifndef DIRECT_RASTERIZATION_BLOCKS_GLSL
#define DIRECT_RASTERIZATION_BLOCKS_GLSL

#extension GL_EXT_scalar_block_layout : require

#include <direct_rasterization/shared.h>
#include <parts/surface.glsl>

layout(set = 0, binding = kBindingBlocks, scalar) uniform BlockBlock {
  BlockConstants grid;
};

#endif
