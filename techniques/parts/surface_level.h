// An isovalue as texel values of a volume texture.
#pragma once

#include "volmark/scene.h"

namespace volmark::parts {

struct SurfaceLevel {
  float threshold; ///< a texel at or above it is inside; -infinity: all are, +infinity: none is
  float texel;     ///< the isovalue itself
};

/// Which voxels are inside does not depend on how a device decodes them: the threshold of integers lies half-way
/// between two of them. An isovalue within 1e-6 of an integer voxel value is that value. `isovalue` is normalised.
SurfaceLevel surfaceLevel(const Scene& scene, double isovalue);

} // namespace volmark::parts
