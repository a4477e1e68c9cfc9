#pragma once

#include "volmark/technique.h"

namespace volmark::direct_rasterization {

TechniqueFactory meshShaderIsosurface();

} // namespace volmark::direct_rasterization
