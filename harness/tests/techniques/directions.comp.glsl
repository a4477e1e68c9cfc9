// Shows each pixel's ray direction as a colour. One invocation is one pixel of one view. Nothing runs after it.
#version 460
#include <volmark/view.glsl>
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, scalar) uniform Views { ViewConstants views[kMaxViews]; };
layout(set = 0, binding = 1, rgba16f) uniform writeonly image2DArray color;
layout(set = 0, binding = 2, r32f) uniform writeonly image2DArray distanceImage;
layout(push_constant, scalar) uniform Push { ivec2 size; };

void main() {
  ivec3 pixel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(pixel.xy, size))) return;
  Ray ray = rayThroughPixel(views[pixel.z], pixel.xy, size);
  imageStore(color, pixel, vec4(0.5 + 0.5 * ray.direction, 1.0));
  imageStore(distanceImage, pixel, vec4(length(ray.origin)));
}
