// What is solid where rays enter: the sides of the box and of clipping planes, and everything for an eye inside. A mesh has
// no triangles there. Solid is what the triangles enclose, not what trilinear interpolation would: no gap is left
// between these sides and the triangles.
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

// Whether the triangle is met between `from` and `from + way`.
bool isCrossed(vec3 from, vec3 way, vec3 a, vec3 b, vec3 c) {
  a -= from;
  b -= from;
  c -= from;
  // The same products for a side that two triangles share.
  bvec3 isLeft = greaterThanEqual(vec3(dot(way, cross(b, c)), dot(way, cross(c, a)), dot(way, cross(a, b))), vec3(0));
  if (any(isLeft) && !all(isLeft)) return false;
  vec3 across = cross(b - a, c - a);
  float at = dot(across, a) / dot(across, way);
  return at > 0.0 && at < 1.0;
}

bool isSolid(vec3 voxel) {
  ivec3 last = frame.dims - 1;
  ivec3 cell = clamp(ivec3(floor(voxel)), ivec3(0), max(last - 1, 0));
  float texels[8];
  uint corners = 0u;
  for (int c = 0; c < 8; ++c) {
    texels[c] = texelAt(min(cell + ivec3(c & 1, (c >> 1) & 1, c >> 2), last));
    if (texels[c] >= surface.threshold) corners |= 1u << c;
  }
  if (corners == 0u || corners == 255u) return corners != 0u;
  // On the way to the far corner each triangle is another side.
  vec3 place = voxel - vec3(cell);
  uvec3 far = uvec3(lessThan(place, vec3(0.5)));
  bool isInside = (corners >> (far.x | far.y << 1 | far.z << 2) & 1u) != 0u;
  for (uint i = 0u; i < triangleCount(corners); ++i) {
    uvec3 edges = triangleEdges(cellTriangles[corners], i);
    vec3 at[3];
    for (int k = 0; k < 3; ++k) {
      ivec3 low = lowerEnd(edges[k]);
      ivec3 direction = edgeDirection(edges[k]);
      int a = low.x | low.y << 1 | low.z << 2;
      int b = a + (direction.x | direction.y << 1 | direction.z << 2);
      at[k] = vec3(low) + shareOfEdge(texels[a], texels[b]) * vec3(direction);
    }
    if (isCrossed(place, vec3(far) - place, at[0], at[1], at[2])) isInside = !isInside;
  }
  return isInside;
}

void main() {
  VolumeGrid grid = volumeGrid(frame);
  Ray ray = rayThroughPixel(frame.views[view], ivec2(gl_FragCoord.xy), frame.size);
  float entry, exit;
  vec3 normal;
  if (!clipRay(frame, ray, entry, exit, normal)) discard;
  vec3 world = clamp(pointOnRay(ray, entry), grid.boxMinimum, grid.boxMaximum);
  if (!isSolid(clamp(toVoxel(grid, world), vec3(0), vec3(frame.dims - 1)))) discard;
  vec3 toEye = -ray.direction;
  color = vec4(shade(kShadingModel, frame.surfaceColor, normal, towardsLight(frame, world, toEye), toEye,
                     frame.lightColor, frame.ambient), 1.0);
  distance = entry * ray.cosine;
  gl_FragDepth = surface.near / max(distance, surface.near);
#ifdef COUNTING
  normalOutput = vec4(normal, 0);
#endif
}
