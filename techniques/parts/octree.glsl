// The way through an octree's levels (Faludi et al. 2021, section 3.4). Before it is included:
//   #define QUESTION <type of what is asked>
//   bool isEmpty(QUESTION asked, ivec3 node, int level)
#ifndef PARTS_OCTREE_GLSL
#define PARTS_OCTREE_GLSL

#include <parts/walk.glsl>

// Finds the largest empty node at or below the level of the search that holds sample `index`, or the leaf. True if it
// is empty. `last`: all samples up to it are in the node. `blockShift`: log2 of a leaf's edge in cells.
//
// Top-down, every search starts at the initial level. Bidirectional, it resumes at the level of the last one, and after
// an empty node one level higher.
bool findEmptyNode(QUESTION asked, int blockShift, int initialLevel, bool bidirectional, inout Walk walk, int index,
                   out int last) {
  ivec3 leaf = cellAt(walk, index) >> blockShift;
  int level = bidirectional ? walk.level : initialLevel;
  bool empty = isEmpty(asked, leaf >> level, level);
  ++walk.nodes;
  while (!empty && level > 0) {
    --level;
    empty = isEmpty(asked, leaf >> level, level);
    ++walk.nodes;
  }
  walk.level = min(level + (empty ? 1 : 0), initialLevel);
  int shift = blockShift + level;
  ivec3 low = (leaf >> level) << shift;
  last = lastInside(walk, low, low + (1 << shift) - 1, index);
  return empty;
}

#endif
