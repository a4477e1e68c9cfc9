// Shows the cached value. One invocation is one pixel of one view. Nothing runs after it.
#version 460
#include <volmark/frame.glsl>

VOLMARK_FRAME(0)
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 1, scalar) readonly buffer Cache { float cache[]; };
layout(set = 0, binding = 2, rgba16f) uniform writeonly image2DArray color;
layout(set = 0, binding = 3, r32f) uniform writeonly image2DArray distanceImage;

void main() {
  ivec3 pixel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(pixel.xy, frame.size))) return;
  float value = cache[(pixel.z * frame.size.y + pixel.y) * frame.size.x + pixel.x];
  float scaled = value / length(frame.boxMaximum - frame.boxMinimum);
  imageStore(color, pixel, vec4(vec3(scaled), 1.0));
  imageStore(distanceImage, pixel, vec4(value > 0.0 ? value : 1.0 / 0.0));
}
