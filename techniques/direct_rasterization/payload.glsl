// What a task workgroup tells its mesh workgroups: the occupied cells of a block, cut into lists (Kreskowski et al. 2022,
// listing 1).
// Macro: VERTEX_LIMIT, of a list.
#ifndef DIRECT_RASTERIZATION_PAYLOAD_GLSL
#define DIRECT_RASTERIZATION_PAYLOAD_GLSL

#extension GL_EXT_mesh_shader : require
#extension GL_EXT_shader_explicit_arithmetic_types_int8 : require
#extension GL_EXT_shader_8bit_storage : require

#include <direct_rasterization/blocks.glsl>

layout(constant_id = kIdBlockX) const int kBlockX = 8;
layout(constant_id = kIdBlockY) const int kBlockY = 8;
layout(constant_id = kIdBlockZ) const int kBlockZ = 4;

// A cell has 12 vertices at most: a list that the limit ended has at least VERTEX_LIMIT / 12 cells.
const int kCellsOfList = VERTEX_LIMIT / 12;
const int kLists = (kMaximumBlockCells + kCellsOfList - 1) / kCellsOfList;

struct Payload {
  uint block;
  uint8_t cells[kMaximumBlockCells]; // in order, x fastest
  uint8_t offsets[kLists];           // of each list in the cells
  uint8_t lengths[kLists];
};
taskPayloadSharedEXT Payload payload;

// Lowest corner of a block's cell.
ivec3 cellOf(uint block, uint cell) {
  ivec3 inBlock = placeOf(cell, ivec3(kBlockX, kBlockY, kBlockZ));
  return placeOf(block, grid.blocks) * ivec3(kBlockX, kBlockY, kBlockZ) + inBlock;
}

#endif
