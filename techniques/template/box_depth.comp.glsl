// Colours the volume's box by how long each ray is inside it.
// One invocation is one pixel of one view (gl_GlobalInvocationID.z). Nothing runs after it.
#version 460
#include <volmark/box.glsl>

VOLMARK_FRAME(0)
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 1, rgba16f) uniform writeonly image2DArray color;
layout(set = 0, binding = 2, r32f) uniform writeonly image2DArray distanceImage;
layout(constant_id = 0) const float kBrightness = 1.0;

void main() {
  ivec3 pixel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(pixel.xy, frame.size))) return;
  Ray ray = rayThroughPixel(frame.views[pixel.z], pixel.xy, frame.size);

  float entry, exit;
  vec3 normal;
  bool hit = clipRay(frame, ray, entry, exit, normal);
  float share = hit ? (exit - entry) / length(frame.boxMaximum - frame.boxMinimum) : 0.0;

  // Every pixel is written: premultiplied colour, and the distance along the view direction.
  imageStore(color, pixel, vec4(vec3(kBrightness * share), hit ? 1.0 : 0.0));
  imageStore(distanceImage, pixel, vec4(hit ? entry * ray.cosine : 1.0 / 0.0));
}
