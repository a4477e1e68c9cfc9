// What is solid where rays enter: the sides of the box and of clipping planes, and everything for an eye inside. A mesh has
// no triangles there.
// Macro: COUNTING, in counting frames: the normal is a third output.
// One invocation is one pixel of a view. The surface is drawn next.
#version 460

#include <parts/surface.glsl>
#include <volmark/box.glsl>

layout(constant_id = kIdSurfaceShadingModel) const uint kShadingModel = 0u;

layout(location = 0) in flat uint view;
layout(location = 0) out vec4 color;
layout(location = 1) out float distance;
#ifdef COUNTING
layout(location = 2) out vec4 normalOutput;
#endif

void main() {
  VolumeGrid grid = volumeGrid(frame);
  Ray ray = rayThroughPixel(frame.views[view], ivec2(gl_FragCoord.xy), frame.size);
  float entry, exit;
  vec3 normal;
  if (!clipRay(frame, ray, entry, exit, normal)) discard;
  vec3 world = clamp(pointOnRay(ray, entry), grid.boxMinimum, grid.boxMaximum);
  // A sample that is the isovalue is inside, as a voxel is, whatever rounding makes of its decoding.
  if (sampleVolume(volume, grid, world, true) < frame.isovalue - 2e-6) discard;
  vec3 toEye = -ray.direction;
  color = vec4(shade(kShadingModel, frame.surfaceColor, normal, towardsLight(frame, world, toEye), toEye,
                     frame.lightColor, frame.ambient), 1.0);
  distance = entry * ray.cosine;
  gl_FragDepth = surface.near / max(distance, surface.near);
#ifdef COUNTING
  normalOutput = vec4(normal, 0);
#endif
}
