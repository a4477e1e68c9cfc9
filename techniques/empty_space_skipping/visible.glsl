// Whether the transfer function shows anything between two scalars: sums over the table's entries that show, so that
// any range costs two reads. One entry more at both ends, as the table's lookups round.
#ifndef EMPTY_SPACE_SKIPPING_VISIBLE_GLSL
#define EMPTY_SPACE_SKIPPING_VISIBLE_GLSL

#extension GL_EXT_scalar_block_layout : require

#include <empty_space_skipping/shared.h>

layout(set = 0, binding = kBindingVisible, scalar) readonly buffer VisibleEntries {
  uint visibleBefore[]; // entry i: how many of the entries before i show
};

bool showsBetween(float low, float high, int entries) {
  precise float first = low * float(entries - 1);
  precise float last = high * float(entries - 1);
  int from = max(int(floor(first)) - 1, 0);
  int to = min(int(ceil(last)) + 1, entries - 1);
  return visibleBefore[to + 1] > visibleBefore[from];
}

#endif
