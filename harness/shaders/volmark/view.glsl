// Rays of a view's pixels, and the inverse: where a view shows a point.
#ifndef VOLMARK_VIEW_GLSL
#define VOLMARK_VIEW_GLSL

#include <volmark/frame.glsl>

// `direction` is normalised. The distance along the view direction of the point at ray parameter t is
// t * cosine: that is what the target's distance image holds.
struct Ray {
  vec3 origin;
  vec3 direction;
  float cosine;
};

// The ray through the centre of `pixel` of a picture of `size` pixels, y down.
Ray rayThroughPixel(ViewConstants view, ivec2 pixel, ivec2 size) {
  vec2 position = (vec2(pixel) + 0.5) / vec2(size);
  float u = view.tangents.x + (view.tangents.y - view.tangents.x) * position.x;
  float v = view.tangents.w + (view.tangents.z - view.tangents.w) * position.y;
  vec3 direction = view.forward + u * view.right + v * view.up;
  float cosine = inversesqrt(dot(direction, direction));
  return Ray(view.position, direction * cosine, cosine);
}

// The point at ray parameter t.
vec3 pointOnRay(Ray ray, float t) {
  return ray.origin + t * ray.direction;
}

// Distance of `world` along the view direction: what the target's distance image holds.
float distanceAlongView(ViewConstants view, vec3 world) {
  return dot(world - view.position, view.forward);
}

// Vulkan clip coordinates (y down) of a point, for rasterising techniques; w is the distance along the view direction.
// Depth is near / w: 1 at `near`, falling to 0 far away, so that floats resolve all distances alike and nothing is cut off
// at the far end. Nearer means greater. The same bits in every shader.
vec4 clipPosition(ViewConstants view, vec3 world, float near) {
  precise vec3 offset = world - view.position;
  precise float x = dot(offset, view.right);
  precise float y = dot(offset, view.up);
  precise float w = dot(offset, view.forward);
  vec4 t = view.tangents;
  precise vec4 clip = vec4((2.0 * x - (t.x + t.y) * w) / (t.y - t.x), ((t.z + t.w) * w - 2.0 * y) / (t.w - t.z), near, w);
  return clip;
}

#endif
