// Blocks that the surface goes through, in order. Macros: those of parts/compact.glsl.
// One invocation is one block. extract.comp.glsl runs next.
#version 460

#extension GL_EXT_scalar_block_layout : require

#include <mesh_isosurface/shared.h>
#include <parts/surface.glsl>

layout(set = 0, binding = kBindingBlocks, scalar) uniform BlockBlock {
  BlockConstants grid;
};
layout(set = 0, binding = kBindingRanges) uniform sampler3D ranges;

const int kCounterKept = -1;

bool keeps(uint item) {
  // A volume of one voxel along an axis has no cells.
  return all(greaterThan(grid.cells, ivec3(0))) && isOccupied(texelFetch(ranges, placeOf(item, grid.blocks), 0).xy);
}

#include <parts/compact.glsl>
