// Sums of counts before each one, in place, their total (kNoIndex if it is beyond 32 bits), and the arguments of indirect
// draws or dispatches over all that was counted.
// One workgroup does it all; an invocation sums a part of each run of kScanGroup counts. What writes the items runs next.
#version 460

#extension GL_EXT_scalar_block_layout : require

#include <parts/surface_shared.h>

layout(local_size_x = kScanGroup) in;

layout(set = 0, binding = 0, scalar) buffer CountsBlock {
  uint counts[];
};
layout(set = 0, binding = 1, scalar) writeonly buffer ArgumentsBlock {
  uvec3 arguments[]; // workgroups of each draw
};
layout(set = 0, binding = 2, scalar) readonly buffer SizesBlock {
  uint sizes[];
};
layout(push_constant, scalar) uniform ScanPush {
  ScanConstants scan;
};

shared uint sums[kScanGroup];

void main() {
  uint lane = gl_LocalInvocationIndex;
  uint groups = scan.sizeIndex == kNoIndex ? scan.groups : sizes[scan.sizeIndex];
  uint before = 0u;
  for (uint first = 0u; first < groups; first += uint(kScanGroup)) {
    uint index = first + lane;
    uint own = index < groups ? counts[index] : 0u;
    sums[lane] = own;
    for (uint offset = 1u; offset < uint(kScanGroup); offset *= 2u) {
      barrier();
      uint other = lane >= offset ? sums[lane - offset] : 0u;
      barrier();
      sums[lane] += other;
    }
    barrier();
    if (index < groups) counts[index] = before + sums[lane] - own;
    uint sum = before + sums[kScanGroup - 1];
    before = before == kNoIndex || sum < before ? kNoIndex : sum;
    barrier();
  }
  if (lane == 0u) counts[scan.totalIndex] = before;
  for (uint draw = lane; draw < scan.draws; draw += uint(kScanGroup)) {
    uint start = draw * scan.chunk;
    uint items = before > start ? min(before - start, scan.chunk) : 0u;
    uint groups = (items + scan.perTask - 1u) / scan.perTask;
    uint rows = (groups + uint(kDispatchWidth) - 1u) / uint(kDispatchWidth);
    arguments[draw] = uvec3(min(groups, uint(kDispatchWidth)), rows, groups == 0u ? 0u : 1u);
  }
}
