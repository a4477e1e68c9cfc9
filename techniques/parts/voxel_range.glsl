// Smallest and largest voxel of a block, by one invocation or by a workgroup of them.
#ifndef PARTS_VOXEL_RANGE_GLSL
#define PARTS_VOXEL_RANGE_GLSL

#include <parts/shared.h>

layout(constant_id = kIdCooperative) const bool kCooperative = false;
layout(local_size_x = kRangeGroup, local_size_y = kRangeGroup, local_size_z = kRangeGroup) in;

layout(set = 0, binding = kBindingVoxels) uniform sampler3D volume;

// The block of this invocation, or of its workgroup if all of it works on one.
ivec3 blockOfInvocation() {
  return ivec3(kCooperative ? gl_WorkGroupID : gl_GlobalInvocationID);
}

// Where an invocation begins in its block, and how far apart its voxels are.
ivec3 firstVoxel() {
  return kCooperative ? ivec3(gl_LocalInvocationID) : ivec3(0);
}
int voxelStride() {
  return kCooperative ? kRangeGroup : 1;
}

const int kLanes = kRangeGroup * kRangeGroup * kRangeGroup;
shared float lowest[kLanes];
shared float highest[kLanes];

// Smallest and largest texel value of voxels low to high (inclusive), valid in the workgroup's first invocation
// (cooperative) or in each. All invocations of a workgroup call it.
vec2 rangeOf(ivec3 low, ivec3 high) {
  float smallest = 3.402823466e38;
  float largest = -3.402823466e38;
  ivec3 first = low + firstVoxel();
  int stride = voxelStride();
  for (int z = first.z; z <= high.z; z += stride)
    for (int y = first.y; y <= high.y; y += stride)
      for (int x = first.x; x <= high.x; x += stride) {
        float texel = texelFetch(volume, ivec3(x, y, z), 0).r;
        smallest = min(smallest, texel);
        largest = max(largest, texel);
      }
  if (kCooperative) {
    uint lane = gl_LocalInvocationIndex;
    lowest[lane] = smallest;
    highest[lane] = largest;
    for (uint part = kLanes / 2; part > 0u; part /= 2u) {
      barrier();
      if (lane < part) {
        lowest[lane] = min(lowest[lane], lowest[lane + part]);
        highest[lane] = max(highest[lane], highest[lane + part]);
      }
    }
    barrier();
    smallest = lowest[0];
    largest = highest[0];
  }
  return vec2(smallest, largest);
}

#endif
