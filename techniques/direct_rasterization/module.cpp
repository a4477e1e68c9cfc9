#include "volmark/module.h"

#include "mesh_shader_isosurface.h"

VOLMARK_MODULE(direct_rasterization, volmark::direct_rasterization::meshShaderIsosurface())
