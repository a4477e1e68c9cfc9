// Direct volume rendering with empty-space skipping: one ray marcher, a technique for each structure.
#pragma once

#include "structure.h"
#include "volmark/technique.h"

namespace volmark::empty_space_skipping {

TechniqueFactory dvrBitfieldOctree();
TechniqueFactory dvrMinMaxOctree();
TechniqueFactory dvrBooleanOctree();
TechniqueFactory dvrDistanceMap();
TechniqueFactory dvrChebyshevDistance();
TechniqueFactory dvrRayQuery();

} // namespace volmark::empty_space_skipping
