// Finds the occupied cells of a block and cuts them into lists for mesh workgroups (Kreskowski et al. 2022, section 3.4.1).
// Macro: VERTEX_LIMIT, of a list.
// One invocation classifies a run of cells along x; a workgroup is one block. extract.mesh.glsl runs next.
#version 460

#include <direct_rasterization/payload.glsl>

layout(local_size_x = kTaskThreads) in;

layout(set = 0, binding = kBindingCounts, scalar) readonly buffer CountsBlock {
  uint counts[];
};
layout(set = 0, binding = kBindingList, scalar) readonly buffer ListBlock {
  uint list[];
};
layout(push_constant, scalar) uniform DrawPush {
  DrawConstants draw;
};

const int kCells = kBlockX * kBlockY * kBlockZ;
const int kRun = kCells / kTaskThreads; // cells of an invocation: a part of a row, at most 8

shared uint occupiedBits[kMaximumBlockCells / 32];
shared uint vertexCounts[kMaximumBlockCells]; // of the occupied cells, in order
shared uint listCount;

// Inside bits of the four voxels (y, z; y + 1, z; y, z + 1; y + 1, z + 1) at one x.
uint insideAt(ivec3 voxel) {
  return isInside(voxel) | (isInside(voxel + ivec3(0, 1, 0)) << 1) | (isInside(voxel + ivec3(0, 0, 1)) << 2) |
         (isInside(voxel + ivec3(0, 1, 1)) << 3);
}

// The case of a cell from the bits at its two ends: corner bits x, y, z are 1, 2, 4.
uint caseOf(uint left, uint right) {
  uint corners = 0u;
  for (uint i = 0u; i < 4u; ++i) corners |= ((left >> i & 1u) | (right >> i & 1u) << 1) << (2u * i);
  return corners;
}

void main() {
  uint lane = gl_LocalInvocationIndex;
  uint item = draw.first + workgroupIndex(gl_WorkGroupID);
  bool valid = item < counts[draw.totalIndex];
  uint block = valid ? list[item] : 0u;
  if (lane < uint(kMaximumBlockCells / 32)) occupiedBits[lane] = 0u;
  if (lane == 0u) listCount = 0u;
  barrier();

  // Vertices of the run's cells, 4 bits each, and which are occupied.
  uint vertices = 0u;
  uint occupied = 0u;
  uint firstCell = lane * uint(kRun);
  ivec3 voxel = cellOf(block, firstCell);
  bool inVolume = valid && all(lessThan(voxel, grid.cells));
  if (inVolume) {
    uint left = insideAt(voxel);
    for (int i = 0; i < kRun; ++i) {
      if (voxel.x + i >= grid.cells.x) break;
      uint right = insideAt(voxel + ivec3(i + 1, 0, 0));
      uint count = uint(bitCount(crossedEdges(caseOf(left, right))));
      vertices |= count << (4 * i);
      if (count > 0u) occupied |= 1u << i;
      left = right;
    }
    if (occupied != 0u) atomicOr(occupiedBits[firstCell >> 5], occupied << (firstCell & 31u));
  }
  barrier();

  // Where the run's cells are among all that are occupied.
  uint before = uint(bitCount(occupiedBits[firstCell >> 5] & ((1u << (firstCell & 31u)) - 1u)));
  uint total = 0u;
  for (uint word = 0u; word < uint(kMaximumBlockCells / 32); ++word) {
    uint cells = uint(bitCount(occupiedBits[word]));
    if (word < firstCell >> 5) before += cells;
    total += cells;
  }
  for (int i = 0; i < kRun; ++i) {
    if ((occupied >> i & 1u) == 0u) continue;
    payload.cells[before] = uint8_t(firstCell + uint(i));
    vertexCounts[before] = (vertices >> (4 * i)) & 15u;
    ++before;
  }
  barrier();

  // A list ends when it is full, or when the next cell would take it over the limit.
  if (lane == 0u && total > 0u) {
    payload.block = block;
    uint lists = 0u;
    uint start = 0u;
    uint sum = 0u;
    for (uint i = 0u; i < total; ++i) {
      uint count = vertexCounts[i];
      if (i - start == uint(kMaximumListCells) || sum + count > uint(VERTEX_LIMIT)) {
        payload.offsets[lists] = uint8_t(start);
        payload.lengths[lists] = uint8_t(i - start);
        ++lists;
        start = i;
        sum = 0u;
      }
      sum += count;
    }
    payload.offsets[lists] = uint8_t(start);
    payload.lengths[lists] = uint8_t(total - start);
    listCount = lists + 1u;
    if (kCounting) {
      addToCounter(uint(kCountCells), total);
      addToCounter(uint(kCountLists), listCount);
    }
  }
  barrier();
  EmitMeshTasksEXT(listCount, 1, 1);
}
