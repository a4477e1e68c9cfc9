// Emission and absorption along rays without acceleration.
#pragma once

#include "volmark/technique.h"

namespace volmark::ray_march {

TechniqueFactory dvrRaymarch();

} // namespace volmark::ray_march
