// What mesh shaders of surfaces write: vertices and triangles for all views, those of a view behind those of the one
// before. To be included behind the layout of the triangles. Macros: VIEWS, of the picture; CLIP, with clipping planes. surface.frag.glsl runs next.
#ifndef PARTS_SURFACE_MESH_OUTPUT_GLSL
#define PARTS_SURFACE_MESH_OUTPUT_GLSL

#include <parts/surface.glsl>

out gl_MeshPerVertexEXT {
  vec4 gl_Position;
#ifdef CLIP
  float gl_ClipDistance[kMaxClippingPlanes];
#endif
} gl_MeshVerticesEXT[];
layout(location = 0) out vec3 normalOutput[];
#if VIEWS > 1
perprimitiveEXT out gl_MeshPerPrimitiveEXT {
  perprimitiveEXT int gl_Layer;
} gl_MeshPrimitivesEXT[];
layout(location = 1) out flat uint viewOutput[];
#endif

// Vertex `index` of `count`.
void writeVertex(uint index, uint count, vec3 position, vec3 normal) {
  for (uint view = 0u; view < VIEWS; ++view) {
    uint target = view * count + index;
    gl_MeshVerticesEXT[target].gl_Position = clipPosition(frame.views[view], position, surface.near);
#ifdef CLIP
    for (int plane = 0; plane < kMaxClippingPlanes; ++plane)
      gl_MeshVerticesEXT[target].gl_ClipDistance[plane] = keptDistance(plane, position);
#endif
    normalOutput[target] = normal;
#if VIEWS > 1
    viewOutput[target] = view;
#endif
  }
}

// Triangle `index` of `count`, of three of `vertices` vertices.
void writeTriangle(uint index, uint count, uvec3 corners, uint vertices) {
  for (uint view = 0u; view < VIEWS; ++view) {
    uint target = view * count + index;
    gl_PrimitiveTriangleIndicesEXT[target] = view * vertices + corners;
#if VIEWS > 1
    gl_MeshPrimitivesEXT[target].gl_Layer = layerOf(view);
#endif
  }
}

#endif
