// Draws meshlets for all views at once. Macros: VIEWS, of the picture; CLIP, with clipping planes.
// One invocation writes every 32nd vertex and triangle; a workgroup is one meshlet. surface.frag.glsl runs next.
#version 460

#extension GL_EXT_mesh_shader : require

#include <mesh_isosurface/vertices.glsl>
#include <parts/surface.glsl>

layout(local_size_x = kMeshletThreads) in;
layout(triangles, max_vertices = kMeshletVertices * VIEWS, max_primitives = kMeshletTriangles * VIEWS) out;

layout(set = 0, binding = kBindingMeshlets, scalar) readonly buffer MeshletsBlock {
  Meshlet meshlets[];
};
layout(set = 0, binding = kBindingMeshletVertices, scalar) readonly buffer MeshletVerticesBlock {
  uint meshletVertices[]; // of the mesh
};
layout(set = 0, binding = kBindingMeshletTriangles, scalar) readonly buffer MeshletTrianglesBlock {
  uint meshletTriangles[]; // three bytes: vertices of the meshlet
};
layout(push_constant, scalar) uniform MeshPush {
  MeshConstants mesh;
};

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

void main() {
  uint index = workgroupIndex(gl_WorkGroupID);
  Meshlet meshlet = Meshlet(0u, 0u, 0u, 0u);
  if (index < mesh.meshlets) meshlet = meshlets[index];
  SetMeshOutputsEXT(meshlet.vertices * VIEWS, meshlet.triangles * VIEWS);
  for (uint i = gl_LocalInvocationIndex; i < meshlet.vertices; i += uint(kMeshletThreads)) {
    Vertex vertex = Vertices(mesh.vertices).vertex[meshletVertices[meshlet.firstVertex + i]];
    for (uint view = 0u; view < VIEWS; ++view) {
      uint target = view * meshlet.vertices + i;
      gl_MeshVerticesEXT[target].gl_Position = clipPosition(frame.views[view], vertex.position, surface.near);
#ifdef CLIP
      for (int plane = 0; plane < kMaxClippingPlanes; ++plane)
        gl_MeshVerticesEXT[target].gl_ClipDistance[plane] = keptDistance(plane, vertex.position);
#endif
      normalOutput[target] = vertex.normal;
#if VIEWS > 1
      viewOutput[target] = view;
#endif
    }
  }
  for (uint i = gl_LocalInvocationIndex; i < meshlet.triangles; i += uint(kMeshletThreads)) {
    uint bytes = meshletTriangles[meshlet.firstTriangle + i];
    uvec3 corners = uvec3(bytes & 255u, bytes >> 8 & 255u, bytes >> 16 & 255u);
    for (uint view = 0u; view < VIEWS; ++view) {
      uint target = view * meshlet.triangles + i;
      gl_PrimitiveTriangleIndicesEXT[target] = view * meshlet.vertices + corners;
#if VIEWS > 1
      gl_MeshPrimitivesEXT[target].gl_Layer = layerOf(view);
#endif
    }
  }
}
