// Choosing items in order, without a limit on their number: compute shaders define, before they include this,
//   bool keeps(uint item)      without barriers
//   const int kCounterKept     the counter of what is kept, or -1
// and are compiled twice: with COUNT, to count what each workgroup keeps, and without, to write it. The scan of
// compact_scan.comp.glsl runs in between. A workgroup has kCompactGroup items, one an invocation.
#ifndef PARTS_COMPACT_GLSL
#define PARTS_COMPACT_GLSL

#include <parts/surface_shared.h>

layout(local_size_x = kCompactGroup) in;

layout(set = 0, binding = COUNTS_BINDING, scalar) buffer CountsBlock {
  uint counts[]; // of each workgroup; their sums before it after the scan
};
layout(set = 0, binding = COUNTS_BINDING + 1, scalar) writeonly buffer KeptBlock {
  uint keptItems[];
};
layout(push_constant, scalar) uniform CompactPush {
  CompactConstants compact;
};

shared uint keptBits[kCompactGroup / 32];

void main() {
  uint group = workgroupIndex(gl_WorkGroupID);
  uint lane = gl_LocalInvocationIndex;
  uint item = group * uint(kCompactGroup) + lane;
  if (lane < uint(kCompactGroup / 32)) keptBits[lane] = 0u;
  barrier();
  bool keep = item < compact.items && keeps(item);
  if (keep) atomicOr(keptBits[lane >> 5], 1u << (lane & 31u));
  barrier();
  uint before = 0u;
  uint total = 0u;
  for (uint word = 0u; word < uint(kCompactGroup / 32); ++word) {
    uint kept = uint(bitCount(keptBits[word]));
    if (word < lane >> 5) before += kept;
    total += kept;
  }
#ifdef COUNT
  if (lane == 0u && group * uint(kCompactGroup) < compact.items) counts[group] = total;
#else
  before += uint(bitCount(keptBits[lane >> 5] & ((1u << (lane & 31u)) - 1u)));
  if (keep) keptItems[counts[group] + before] = item;
  if (kCounting && kCounterKept >= 0 && lane == 0u) addToCounter(uint(kCounterKept), total);
#endif
}

#endif
