// Occupied blocks that a pass draws, in order (Kreskowski et al. 2022, sections 3.5.1 and 3.5.2: the index lists of visible
// sets). Differs from the paper: chosen here instead of in a task shader that every block starts, because empty task
// workgroups are dear on some devices.
// Specialisation: kChoice. Macros: those of parts/compact.glsl.
// One invocation is one block. extract.task.glsl runs next.
#version 460

#include <direct_rasterization/blocks.glsl>

layout(constant_id = kIdChoice) const int kChoice = kChooseOccupied;

layout(set = 0, binding = kBindingRanges) uniform sampler3D ranges;
layout(set = 0, binding = kBindingPrevious, scalar) readonly buffer PreviousBlock {
  uint wasVisible[];
};
layout(set = 0, binding = kBindingVisible, scalar) readonly buffer VisibleBlock {
  uint isVisible[];
};

const int kCounterKept = kCountBlocks;

bool keeps(uint item) {
  ivec3 block = placeOf(item, grid.blocks);
  if (kChoice != kChooseOccupied) {
    uint region = indexOf(block / grid.perRegion, grid.regions);
    bool before = wasVisible[region] != 0u;
    if (kChoice == kChoosePrevious ? !before : before || isVisible[region] == 0u) return false;
  }
  return isOccupied(texelFetch(ranges, block, 0).xy);
}

#include <parts/compact.glsl>
