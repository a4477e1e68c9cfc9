// Blocks of cells and the regions that hold them, for what chooses them.
#ifndef DIRECT_RASTERIZATION_BLOCKS_GLSL
#define DIRECT_RASTERIZATION_BLOCKS_GLSL

#extension GL_EXT_scalar_block_layout : require

#include <direct_rasterization/shared.h>
#include <parts/surface.glsl>

layout(set = 0, binding = kBindingBlocks, scalar) uniform BlockBlock {
  BlockConstants grid;
};

// Items are numbered x fastest.
ivec3 placeOf(uint item, ivec3 size) {
  uint row = item / uint(size.x);
  return ivec3(item - row * uint(size.x), row % uint(size.y), row / uint(size.y));
}
uint indexOf(ivec3 place, ivec3 size) {
  return uint((place.z * size.y + place.y) * size.x + place.x);
}

#endif
