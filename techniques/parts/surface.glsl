// The isosurface in a cell: its case, its vertices, their normals (Lorensen and Cline 1987). Positions and gradients have
// the same bits in every shader, so that neighbours in other blocks and other techniques get the same vertex of an edge.
#ifndef PARTS_SURFACE_GLSL
#define PARTS_SURFACE_GLSL

#include <parts/surface_shared.h>
#include <volmark/counters.glsl>
#include <volmark/frame.glsl>
#include <volmark/shading.glsl>
#include <volmark/view.glsl>
#include <volmark/volume.glsl>

layout(constant_id = kIdSurfaceCounting) const bool kCounting = false;

VOLMARK_FRAME(kSurfaceFrame)
layout(set = 0, binding = kSurfaceVolume) uniform sampler3D volume;
layout(set = 0, binding = kSurfaceLevel, scalar) uniform SurfaceBlock {
  SurfaceConstants surface;
};
layout(set = 0, binding = kSurfaceTable, scalar) readonly buffer TableBlock {
  uvec2 cellTriangles[256]; // marching_cubes_table.h: 15 nibbles of edges, the number of triangles
};
VOLMARK_COUNTERS(kSurfaceCounters)

// The test of everything: a range of texel values that the surface goes through.
bool isOccupied(vec2 range) {
  return range.x < surface.threshold && range.y >= surface.threshold;
}

float texelAt(ivec3 voxel) {
  return texelFetch(volume, voxel, 0).r;
}

uint isInside(ivec3 voxel) {
  return texelAt(voxel) >= surface.threshold ? 1u : 0u;
}

// Bit c: corner c, at (c & 1, (c >> 1) & 1, c >> 2), is inside.
uint caseOfCell(ivec3 cell) {
  uint corners = 0u;
  for (int c = 0; c < 8; ++c) corners |= isInside(cell + ivec3(c & 1, (c >> 1) & 1, c >> 2)) << c;
  return corners;
}

// Bits 0, 2, 4 and 6; bits 0, 1, 4 and 5: next to each other.
uint gatherEven(uint bits) {
  return (bits & 1u) | ((bits >> 1) & 2u) | ((bits >> 2) & 4u) | ((bits >> 3) & 8u);
}
uint gatherPairs(uint bits) {
  return (bits & 3u) | ((bits >> 2) & 12u);
}

// Bit e: the surface crosses edge e. The vertices of a cell are its crossed edges, in this order.
uint crossedEdges(uint corners) {
  uint alongX = gatherEven(corners ^ (corners >> 1));
  uint alongY = gatherPairs(corners ^ (corners >> 2));
  uint alongZ = (corners ^ (corners >> 4)) & 15u;
  return alongX | (alongY << 4) | (alongZ << 8);
}

uint triangleCount(uint corners) {
  return cellTriangles[corners].y >> 28;
}

// Edges of triangle i of an entry of cellTriangles.
uvec3 triangleEdges(uvec2 bits, uint i) {
  uvec3 shift = 12u * i + uvec3(0, 4, 8);
  return uvec3(((shift.x < 32u ? bits.x >> shift.x : bits.y >> (shift.x - 32u))) & 15u,
               ((shift.y < 32u ? bits.x >> shift.y : bits.y >> (shift.y - 32u))) & 15u,
               ((shift.z < 32u ? bits.x >> shift.z : bits.y >> (shift.z - 32u))) & 15u);
}

// Place of an edge's vertex among those of its cell.
uint vertexIndex(uint edges, uint edge) {
  return uint(bitCount(edges & ((1u << edge) - 1u)));
}

// Of the end with the lower coordinate, and from there to the other one.
ivec3 lowerEnd(uint edge) {
  int a = int(edge & 1u);
  int b = int((edge >> 1) & 1u);
  return edge < 4u ? ivec3(0, a, b) : edge < 8u ? ivec3(a, 0, b) : ivec3(a, b, 0);
}
ivec3 edgeDirection(uint edge) {
  return edge < 4u ? ivec3(1, 0, 0) : edge < 8u ? ivec3(0, 1, 0) : ivec3(0, 0, 1);
}

// Where the surface crosses an edge between two voxels, from the first on. Never at a voxel: where voxels are the isovalue,
// triangles of several cells would lie in one place, and have no area.
float shareOfEdge(float a, float b) {
  precise float t = clamp((surface.texel - a) / (b - a), kEdgeMargin, 1.0 - kEdgeMargin);
  return t;
}

struct SurfaceVertex {
  vec3 position; // world
  vec3 normal;   // unit, towards lower values, by central differences; 0 where there is no gradient
};

// The vertex on the edge from voxel `low` on. All that its samples interpolate lies on lines along the edge.
SurfaceVertex vertexOnEdge(ivec3 low, ivec3 direction) {
  ivec3 high = low + direction;
  float a = texelAt(low);
  float b = texelAt(high);
  float t = shareOfEdge(a, b);
  precise vec3 voxel = vec3(low) + t * vec3(direction);
  precise vec3 world = frame.boxMinimum + voxel * frame.spacing;

  ivec3 second = direction.zxy;
  ivec3 third = direction.yzx;
  ivec3 last = frame.dims - 1;
  precise vec3 ahead = mix(vec3(b, texelAt(min(low + second, last)), texelAt(min(low + third, last))),
                   vec3(texelAt(min(high + direction, last)), texelAt(min(high + second, last)),
                        texelAt(min(high + third, last))), t);
  precise vec3 behind = mix(vec3(texelAt(max(low - direction, 0)), texelAt(max(low - second, 0)), texelAt(max(low - third, 0))),
                    vec3(a, texelAt(max(high - second, 0)), texelAt(max(high - third, 0))), t);
  precise vec3 difference = clamp(frame.valueScale * ahead + frame.valueBias, 0.0, 1.0) -
                    clamp(frame.valueScale * behind + frame.valueBias, 0.0, 1.0);
  precise vec3 span = (min(voxel + 1.0, vec3(last)) - max(voxel - 1.0, 0.0)) * frame.spacing;
  precise vec3 gradient =
      (difference.x * vec3(direction) + difference.y * vec3(second) + difference.z * vec3(third)) / span;
  return SurfaceVertex(world, normalOfGradient(gradient));
}

// Items are numbered x fastest.
ivec3 placeOf(uint item, ivec3 size) {
  uint row = item / uint(size.x);
  return ivec3(item - row * uint(size.x), row % uint(size.y), row / uint(size.y));
}
uint indexOf(ivec3 place, ivec3 size) {
  return uint((place.z * size.y + place.y) * size.x + place.x);
}

// Index of an item of an indirect dispatch or draw that may have rows.
uint workgroupIndex(uvec3 workgroup) {
  return workgroup.y * uint(kDispatchWidth) + workgroup.x;
}

// How far a vertex is on the kept side of a clipping plane; planes that are not there keep everything.
float keptDistance(int plane, vec3 world) {
  if (uint(plane) >= frame.clippingPlaneCount) return 1.0;
  return dot(frame.clippingPlanes[plane].xyz, world) - frame.clippingPlanes[plane].w;
}

int layerOf(uint view) {
  return int(bitfieldExtract(surface.layers, int(8u * view), 8));
}

#endif
