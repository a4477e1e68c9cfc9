// Sums of counts before each one, in place, their total (kNoIndex if it is beyond 32 bits), and the arguments of indirect
// draws or dispatches over all that was counted.
// One workgroup does it all; an invocation sums counts that lie behind each other. What writes the items runs next.
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

// kNoIndex, once reached, stays.
uint add(uint a, uint b) {
  uint sum = a + b;
  return a == kNoIndex || b == kNoIndex || sum < a ? kNoIndex : sum;
}

void main() {
  uint lane = gl_LocalInvocationIndex;
  uint groups = scan.sizeIndex == kNoIndex ? scan.groups : sizes[scan.sizeIndex];
  uint part = (groups + uint(kScanGroup) - 1u) / uint(kScanGroup);
  uint first = min(lane * part, groups);
  uint end = min(first + part, groups);
  uint own = 0u;
  for (uint i = first; i < end; ++i) own = add(own, counts[i]);
  sums[lane] = own;
  for (uint offset = 1u; offset < uint(kScanGroup); offset *= 2u) {
    barrier();
    uint other = lane >= offset ? sums[lane - offset] : 0u;
    barrier();
    sums[lane] = add(sums[lane], other);
  }
  barrier();
  uint before = lane == 0u ? 0u : sums[lane - 1u];
  for (uint i = first; i < end; ++i) {
    uint count = counts[i];
    counts[i] = before;
    before = add(before, count);
  }
  uint total = sums[kScanGroup - 1];
  if (lane == 0u) counts[scan.totalIndex] = total;
  for (uint draw = lane; draw < scan.draws; draw += uint(kScanGroup)) {
    uint start = draw * scan.chunk;
    uint items = total > start ? min(total - start, scan.chunk) : 0u;
    uint groups = (items + scan.perTask - 1u) / scan.perTask;
    uint rows = (groups + uint(kDispatchWidth) - 1u) / uint(kDispatchWidth);
    arguments[draw] = uvec3(min(groups, uint(kDispatchWidth)), rows, groups == 0u ? 0u : 1u);
  }
}
