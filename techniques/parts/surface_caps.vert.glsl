// A triangle over the whole picture of each view (instance). One invocation is one of its corners; surface_caps.frag.glsl
// runs next.
#version 460

#extension GL_ARB_shader_viewport_layer_array : require

#include <parts/surface.glsl>

layout(location = 0) out flat uint view;

void main() {
  view = uint(gl_InstanceIndex);
  gl_Layer = layerOf(view);
  gl_Position = vec4(4.0 * vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) - 1.0, 0.5, 1.0);
}
