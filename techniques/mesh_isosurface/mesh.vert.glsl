// Vertices of an indexed mesh. Macros: VIEWS, of the picture; CLIP, with clipping planes.
// One invocation is one vertex of one view (instance). surface.frag.glsl runs next, or nothing.
#version 460

#extension GL_ARB_shader_viewport_layer_array : require

#include <mesh_isosurface/vertices.glsl>
#include <parts/surface.glsl>

layout(push_constant, scalar) uniform MeshPush {
  MeshConstants mesh;
};

#ifdef CLIP
out gl_PerVertex {
  vec4 gl_Position;
  float gl_ClipDistance[kMaxClippingPlanes];
};
#endif
invariant gl_Position; // of the prepass and of what follows it
layout(location = 0) out vec3 normal;
#if VIEWS > 1
layout(location = 1) out flat uint view;
#else
const uint view = 0u;
#endif

void main() {
  Vertex vertex = Vertices(mesh.vertices).vertex[gl_VertexIndex];
  normal = vertex.normal;
#if VIEWS > 1
  view = uint(gl_InstanceIndex);
  gl_Layer = layerOf(view);
#endif
  gl_Position = clipPosition(frame.views[view], vertex.position, surface.near);
#ifdef CLIP
  for (int plane = 0; plane < kMaxClippingPlanes; ++plane) gl_ClipDistance[plane] = keptDistance(plane, vertex.position);
#endif
}
