#pragma once

#include "volmark/technique.h"

namespace volmark::mesh_isosurface {

TechniqueFactory marchingCubes();

} // namespace volmark::mesh_isosurface
