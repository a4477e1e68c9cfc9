#pragma once

#include "volmark/technique.h"

namespace volmark::octree_isosurface {

TechniqueFactory isoOctree();

} // namespace volmark::octree_isosurface
