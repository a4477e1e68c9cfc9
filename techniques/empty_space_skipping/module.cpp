#include "volmark/module.h"

#include "skipping_technique.h"

using namespace volmark::empty_space_skipping;

VOLMARK_MODULE(empty_space_skipping, dvrBitfieldOctree(), dvrMinMaxOctree(), dvrBooleanOctree(), dvrDistanceMap(),
               dvrChebyshevDistance(), dvrRayQuery())
