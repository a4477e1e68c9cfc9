// The voxels of a block, for what builds structures: the same test as on the CPU, bit by bit.
#ifndef EMPTY_SPACE_SKIPPING_BLOCK_GLSL
#define EMPTY_SPACE_SKIPPING_BLOCK_GLSL

#extension GL_EXT_scalar_block_layout : require

#include <empty_space_skipping/shared.h>
#include <parts/voxel_range.glsl>

layout(push_constant, scalar) uniform BuildBlock {
  BuildConstants build;
};

// Voxels low to high (inclusive) belong to a block; a block of cells has those of the next one's side, too.
void voxelsOf(ivec3 block, out ivec3 low, out ivec3 high) {
  low = block * build.blockEdge;
  high = min(low + build.blockEdge - build.voxelBlocks, build.dims - 1);
}

// The stored integer, or the float: exact whatever the device makes of UNORM.
float rawValue(float texel) {
  return build.rawScale > 0.0 ? round(texel * build.rawScale) : texel;
}

float scalarOf(float texel) {
  precise float scalar = build.scalarScale * rawValue(texel) + build.scalarBias;
  return clamp(scalar, 0.0, 1.0);
}

int binOf(float scalar) {
  return min(int(scalar * float(build.bits)), build.bits - 1);
}

// Smallest and largest texel value of a block, as rangeOf() gives it.
vec2 rangeOfBlock(ivec3 block) {
  ivec3 low, high;
  voxelsOf(block, low, high);
  return rangeOf(low, high);
}

#endif
