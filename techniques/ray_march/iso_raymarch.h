// Direct isosurface ray casting without acceleration.
#pragma once

#include "volmark/technique.h"

namespace volmark::ray_march {

TechniqueFactory isoRaymarch();

} // namespace volmark::ray_march
