#include "volmark/module.h"

#include "marching_cubes.h"
#include "optimized_mesh.h"

VOLMARK_MODULE(mesh_isosurface, volmark::mesh_isosurface::marchingCubes(), volmark::mesh_isosurface::optimizedMesh())
