// Adds one random sample per pixel to a running sum and shows the mean: the simplest visible history.
// One invocation is one pixel of one view. Nothing runs after it.
#version 460
#include <volmark/random.glsl>
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, rgba16f) uniform writeonly image2DArray color;
layout(set = 0, binding = 1, r32f) uniform writeonly image2DArray distanceImage;
layout(set = 0, binding = 2, scalar) buffer Sums { float sums[]; };
layout(push_constant, scalar) uniform Push { ivec2 size; uint frameIndex; uint seed; };

void main() {
  ivec3 pixel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(pixel.xy, size))) return;
  uint index = uint((pixel.z * size.y + pixel.y) * size.x + pixel.x);
  float value = toUnitFloat(randomBits(seed, index, frameIndex, 0u));
  float sum = (frameIndex == 0u ? 0.0 : sums[index]) + value;
  sums[index] = sum;
  imageStore(color, pixel, vec4(vec3(sum / float(frameIndex + 1u)), 1.0));
  imageStore(distanceImage, pixel, vec4(1.0 / 0.0));
}
