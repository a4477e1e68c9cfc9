// The walk of a volume's ray. With pre-integration the exit follows the samples as one more place, the end of the last slab.
#ifndef EMPTY_SPACE_SKIPPING_WALK_GLSL
#define EMPTY_SPACE_SKIPPING_WALK_GLSL

#include <empty_space_skipping/shared.h>
#include <parts/emission_absorption.glsl>
#include <parts/walk.glsl>

layout(constant_id = kIdVoxelBlocks) const bool kVoxelBlocks = false;

layout(set = 0, binding = kBindingSkipping, scalar) uniform SkippingBlock {
  SkippingConstants skipping;
};

Walk makeWalk(VolumeGrid grid, Path path) {
#ifdef PREINTEGRATED
  int end = sampleEnd(path) + 1;
#else
  int end = sampleEnd(path);
#endif
  return makeWalk(grid, path, path.shift, end, kVoxelBlocks, skipping.initialLevel);
}

#endif
