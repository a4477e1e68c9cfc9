// Fills the cache with a value per pixel that depends on the camera alone. One invocation is one pixel of one
// view. show_cache.comp.glsl runs next.
#version 460
#include <volmark/box.glsl>

VOLMARK_FRAME(0)
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 1, scalar) buffer Cache { float cache[]; };

void main() {
  ivec3 pixel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(pixel.xy, frame.size))) return;
  Ray ray = rayThroughPixel(frame.views[pixel.z], pixel.xy, frame.size);
  float entry, exit;
  vec3 normal;
  bool inside = clipRay(frame, ray, entry, exit, normal);
  cache[(pixel.z * frame.size.y + pixel.y) * frame.size.x + pixel.x] = inside ? exit - entry : 0.0;
}
