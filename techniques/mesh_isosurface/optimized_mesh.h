#pragma once

#include "volmark/technique.h"

namespace volmark::mesh_isosurface {

TechniqueFactory optimizedMesh();

} // namespace volmark::mesh_isosurface
