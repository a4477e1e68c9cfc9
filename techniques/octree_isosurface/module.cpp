#include "volmark/module.h"

#include "iso_octree.h"

VOLMARK_MODULE(octree_isosurface, volmark::octree_isosurface::isoOctree())
