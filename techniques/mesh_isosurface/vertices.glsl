// Vertices by address.
#ifndef MESH_ISOSURFACE_VERTICES_GLSL
#define MESH_ISOSURFACE_VERTICES_GLSL

#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include <mesh_isosurface/shared.h>

layout(buffer_reference, scalar) buffer Vertices {
  Vertex vertex[];
};

#endif
