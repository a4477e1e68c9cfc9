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

// On which side of the line from a to b a way from the origin goes by. The same product for both triangles that share the
// line, and the other answer: a way through it, as common ones go (at x = z, say), crosses just one of them.
bool isLeft(vec3 way, vec3 a, vec3 b, uint edgeOfA, uint edgeOfB) {
  bool isTurned = edgeOfA > edgeOfB;
  vec3 first = isTurned ? b : a;
  vec3 second = isTurned ? a : b;
  precise float product = way.x * (first.y * second.z - first.z * second.y) +
                          way.y * (first.z * second.x - first.x * second.z) +
                          way.z * (first.x * second.y - first.y * second.x);
  return (product >= 0.0) != isTurned;
}

// Whether the triangle on these edges is met between the origin and `way`.
bool isCrossed(vec3 way, vec3 at[3], uvec3 edges) {
  bool isLeftOfFirst = isLeft(way, at[0], at[1], edges.x, edges.y);
  if (isLeft(way, at[1], at[2], edges.y, edges.z) != isLeftOfFirst ||
      isLeft(way, at[2], at[0], edges.z, edges.x) != isLeftOfFirst)
    return false;
  vec3 across = cross(at[1] - at[0], at[2] - at[0]);
  float share = dot(across, at[0]) / dot(across, way);
  return share > 0.0 && share < 1.0;
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
      precise vec3 corner = vec3(low) + shareOfEdge(texels[a], texels[b]) * vec3(direction) - place;
      at[k] = corner;
    }
    if (isCrossed(vec3(far) - place, at, edges)) isInside = !isInside;
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
