// Shades a rasterised isosurface.
// Macros: VIEWS, of the picture; COUNTING, in counting frames: the normal is a third output.
// One invocation is one fragment. Nothing runs after it.
#version 460

#include <parts/surface_shared.h>
#include <volmark/frame.glsl>
#include <volmark/shading.glsl>
#include <volmark/view.glsl>

layout(constant_id = kIdSurfaceShadingModel) const uint kShadingModel = 0u;

VOLMARK_FRAME(kSurfaceFrame)

layout(location = 0) in vec3 normal;    // unit at vertices
#if VIEWS > 1
layout(location = 1) in flat uint view;
#else
const uint view = 0u;
#endif
layout(location = 0) out vec4 color;
layout(location = 1) out float distance; // along the view direction
#ifdef COUNTING
layout(location = 2) out vec4 normalOutput;
#endif

void main() {
  Ray ray = rayThroughPixel(frame.views[view], ivec2(gl_FragCoord.xy), frame.size);
  float size = length(normal);
  vec3 unit = size < 1e-6 ? vec3(0) : normal / size;
  distance = 1.0 / gl_FragCoord.w;
  vec3 world = pointOnRay(ray, distance / ray.cosine);
  vec3 toEye = -ray.direction;
  color = vec4(shade(kShadingModel, frame.surfaceColor, unit, towardsLight(frame, world, toEye), toEye, frame.lightColor,
                     frame.ambient), 1.0);
#ifdef COUNTING
  normalOutput = vec4(unit, 0);
#endif
}
