// Leaves of an octree, from the voxels of their blocks (Faludi et al. 2021, section 3.3).
// Macros: NODE_FORMAT, the image's format; BITFIELD, BOOLEAN, or LABELS (section 5).
// One invocation (one workgroup, if cooperative) is one leaf. octree_parents.comp.glsl runs next.
#version 460

#include <empty_space_skipping/block.glsl>
#ifdef BOOLEAN
#include <empty_space_skipping/visible.glsl>
#endif

layout(set = 0, binding = kBindingNodes, NODE_FORMAT) uniform writeonly uimage3D nodes;

// Bits 0 to count - 1, of a count that may lie beyond the word.
uint lowBits(int count) {
  return count <= 0 ? 0u : count >= 32 ? 0xffffffffu : (1u << uint(count)) - 1u;
}

#if defined(BITFIELD) || defined(LABELS)
shared uint bitsOfGroup[4];

int bitOf(float texel) {
#ifdef LABELS
  return int(rawValue(texel));
#else
  return binOf(scalarOf(texel));
#endif
}

// The bins of a block's voxels (section 3.1), or their labels: with blocks of cells, those of all voxels that are nearest
// to a place in them.
uvec4 bitsOfVoxels(ivec3 block) {
  ivec3 low, high;
  voxelsOf(block, low, high);
  if (kCooperative && gl_LocalInvocationIndex < 4u) bitsOfGroup[gl_LocalInvocationIndex] = 0u;
  barrier();
  uvec4 bits = uvec4(0);
  ivec3 first = low + firstVoxel();
  int stride = voxelStride();
  for (int z = first.z; z <= high.z; z += stride)
    for (int y = first.y; y <= high.y; y += stride)
      for (int x = first.x; x <= high.x; x += stride) {
        int bin = bitOf(texelFetch(volume, ivec3(x, y, z), 0).r);
        bits[bin >> 5] |= 1u << uint(bin & 31);
      }
  if (kCooperative) {
    for (int word = 0; word < 4; ++word)
      if (bits[word] != 0u) atomicOr(bitsOfGroup[word], bits[word]);
    barrier();
    bits = uvec4(bitsOfGroup[0], bitsOfGroup[1], bitsOfGroup[2], bitsOfGroup[3]);
  }
  return bits;
}
#endif

#ifdef BITFIELD
// Every bin that a trilinear value in the block can lie in. A cell's are those from its lowest to its highest corner;
// neighbouring cells share corners, so that a block's are all from its lowest to its highest voxel.
uvec4 binsOfCells(ivec3 block) {
  vec2 range = rangeOfBlock(block);
  int low = binOf(scalarOf(range.x));
  int high = binOf(scalarOf(range.y));
  uvec4 bits;
  for (int word = 0; word < 4; ++word)
    bits[word] = lowBits(high + 1 - 32 * word) & ~lowBits(low - 32 * word);
  return bits;
}
#endif

void main() {
  ivec3 node = blockOfInvocation();
  bool isBlock = all(lessThan(node, build.blocks));
  bool writes = all(lessThan(node, build.nodes)) && (!kCooperative || gl_LocalInvocationIndex == 0u);
#if defined(BITFIELD) || defined(LABELS)
#ifdef LABELS
  uvec4 bits = bitsOfVoxels(node);
#else
  uvec4 bits = build.voxelBlocks != 0 ? bitsOfVoxels(node) : binsOfCells(node);
#endif
  if (writes) imageStore(nodes, node, isBlock ? bits : uvec4(0));
#else
  vec2 range = rangeOfBlock(node);
  if (writes) {
    bool shows = isBlock && showsBetween(scalarOf(range.x), scalarOf(range.y), build.tableEntries);
    imageStore(nodes, node, uvec4(shows ? 1u : 0u));
  }
#endif
}
