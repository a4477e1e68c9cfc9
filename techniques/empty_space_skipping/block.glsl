// The voxels of a block, for what builds structures: the same test as on the CPU, bit by bit.
#ifndef EMPTY_SPACE_SKIPPING_BLOCK_GLSL
#define EMPTY_SPACE_SKIPPING_BLOCK_GLSL

#extension GL_EXT_scalar_block_layout : require

#include <empty_space_skipping/shared.h>

layout(constant_id = kIdCooperative) const bool kCooperative = false;
layout(local_size_x = kBuildGroup, local_size_y = kBuildGroup, local_size_z = kBuildGroup) in;

layout(set = 0, binding = kBindingVoxels) uniform sampler3D volume;
layout(push_constant, scalar) uniform BuildBlock {
  BuildConstants build;
};

// The block of this invocation, or of its workgroup if all of it works on one.
ivec3 blockOfInvocation() {
  return ivec3(kCooperative ? gl_WorkGroupID : gl_GlobalInvocationID);
}

// Where an invocation begins in its block, and how far apart its voxels are.
ivec3 firstVoxel() {
  return kCooperative ? ivec3(gl_LocalInvocationID) : ivec3(0);
}
int voxelStride() {
  return kCooperative ? kBuildGroup : 1;
}

// Voxels low to high (inclusive) belong to a block; a block of cells has those of the next one's side, too.
void voxelsOf(ivec3 block, out ivec3 low, out ivec3 high) {
  low = block * build.blockEdge;
  high = min(low + build.blockEdge - build.voxelBlocks, build.dims - 1);
}

// The stored integer, or the float: exact whatever the device makes of UNORM.
float rawValue(float texel) {
  return build.rawScale > 0.0 ? round(texel * build.rawScale) : texel;
}

float scalarOf(float texel) {
  precise float scalar = build.scalarScale * rawValue(texel) + build.scalarBias;
  return clamp(scalar, 0.0, 1.0);
}

int binOf(float scalar) {
  return min(int(scalar * float(build.bits)), build.bits - 1);
}

const int kLanes = kBuildGroup * kBuildGroup * kBuildGroup;
shared float lowest[kLanes];
shared float highest[kLanes];

// Smallest and largest texel value of a block, valid in the workgroup's first invocation (cooperative) or in each.
// All invocations of a workgroup call it.
vec2 rangeOf(ivec3 block) {
  ivec3 low, high;
  voxelsOf(block, low, high);
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
