// Which way a file's axes point.
//
// Files say it in the patient's system LPS (x to the left, y to the back, z to the crown; what ITK gives for every
// format). The same volume is stored as left-to-right in one file and right-to-left in another: shown as stored, one
// would be the mirror image of the other. So voxels are turned and flipped until their axes point along L, P and S as
// nearly as a permutation can. A remaining rotation is not applied; a note says how large it is.
#pragma once

#include "volmark/volume.h"

#include <string>
#include <vector>

namespace volmark {

struct Orientation {
  glm::ivec3 fileAxis{0, 1, 2};   ///< fileAxis[i]: the file's axis that becomes axis i
  glm::bvec3 reversed{false};     ///< in the order of the new axes
  double largestAngleDegrees = 0; ///< between a new axis and where it should point
  bool asStored() const { return fileAxis == glm::ivec3(0, 1, 2) && !glm::any(reversed); }
};

/// `directions`: columns are the unit vectors of the file's axes in LPS. As stored where they are not finite or
/// not independent.
Orientation nearestOrientation(const glm::dmat3& directions);

/// Reorders the voxels of every time step and the axes of `grid`. Adds a note where something was turned, or where
/// a rotation of over half a degree remains. `voxels` is returned untouched if its axes point right already.
std::vector<std::byte> turnToPatientAxes(std::vector<std::byte> voxels, ScalarType type, int timeSteps,
                                         const glm::dmat3& directions, Grid& grid, std::vector<std::string>& notes);

} // namespace volmark
