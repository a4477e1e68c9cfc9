// Draws meshlets for all views at once. Macros: VIEWS, of the picture; CLIP, with clipping planes.
// One invocation writes every 32nd vertex and triangle; a workgroup is one meshlet. surface.frag.glsl runs next.
#version 460

#extension GL_EXT_mesh_shader : require

#include <mesh_isosurface/vertices.glsl>

layout(local_size_x = kMeshletThreads) in;
layout(triangles, max_vertices = kMeshletVertices * VIEWS, max_primitives = kMeshletTriangles * VIEWS) out;

#include <parts/surface_mesh_output.glsl>

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

void main() {
  uint index = workgroupIndex(gl_WorkGroupID);
  Meshlet meshlet = Meshlet(0u, 0u, 0u, 0u);
  if (index < mesh.meshlets) meshlet = meshlets[index];
  SetMeshOutputsEXT(meshlet.vertices * VIEWS, meshlet.triangles * VIEWS);
  for (uint i = gl_LocalInvocationIndex; i < meshlet.vertices; i += uint(kMeshletThreads)) {
    Vertex vertex = Vertices(mesh.vertices).vertex[meshletVertices[meshlet.firstVertex + i]];
    writeVertex(i, meshlet.vertices, vertex.position, vertex.normal);
  }
  for (uint i = gl_LocalInvocationIndex; i < meshlet.triangles; i += uint(kMeshletThreads)) {
    uint bytes = meshletTriangles[meshlet.firstTriangle + i];
    uvec3 corners = uvec3(bytes & 255u, bytes >> 8 & 255u, bytes >> 16 & 255u);
    writeTriangle(i, meshlet.triangles, corners, meshlet.vertices);
  }
}
