#include "volume/orientation.h"

#include "volume/voxel_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

namespace volmark {

namespace {

constexpr double kLeastDeterminant = 1e-3; // of unit vectors; below, two axes point the same way
constexpr double kObliqueDegrees = 0.5;

std::string describe(const Orientation& orientation) {
  std::string text;
  for (int i = 0; i < 3; ++i)
    text += fmt::format("{}{}", orientation.reversed[i] ? '-' : '+', "xyz"[orientation.fileAxis[i]]);
  return text;
}

} // namespace

Orientation nearestOrientation(const glm::dmat3& directions) {
  Orientation best;
  const double determinant = glm::determinant(directions);
  if (!(std::abs(determinant) > kLeastDeterminant)) return best;
  double bestSum = -1;
  glm::ivec3 axes{0, 1, 2};
  do {
    double sum = 0;
    for (int i = 0; i < 3; ++i)
      sum += std::abs(directions[axes[i]][i]);
    if (sum <= bestSum + 1e-9) continue;
    bestSum = sum;
    best.fileAxis = axes;
  } while (std::next_permutation(&axes[0], &axes[0] + 3));
  for (int i = 0; i < 3; ++i) {
    const double cosine = directions[best.fileAxis[i]][i];
    best.reversed[i] = cosine < 0;
    const double angle = std::acos(std::min(1.0, std::abs(cosine))) * 180 / std::numbers::pi;
    best.largestAngleDegrees = std::max(best.largestAngleDegrees, angle);
  }
  return best;
}

std::vector<std::byte> turnToPatientAxes(std::vector<std::byte> voxels, ScalarType type, int timeSteps,
                                         const glm::dmat3& directions, Grid& grid, std::vector<std::string>& notes) {
  const Orientation orientation = nearestOrientation(directions);
  if (orientation.largestAngleDegrees > kObliqueDegrees)
    notes.push_back(fmt::format("the file's axes are rotated by {:.1f} degrees against the patient's; shown unrotated",
                                orientation.largestAngleDegrees));
  if (orientation.asStored()) return voxels;
  notes.push_back(fmt::format("axes turned to left, back, crown: the file's {}", describe(orientation)));

  const Grid stored = grid;
  const std::array<std::ptrdiff_t, 3> fileStride = {1, stored.dims.x, std::ptrdiff_t(stored.dims.x) * stored.dims.y};
  std::array<std::ptrdiff_t, 3> stride;
  std::ptrdiff_t first = 0;
  for (int i = 0; i < 3; ++i) {
    const int from = orientation.fileAxis[i];
    grid.dims[i] = stored.dims[from];
    grid.spacingMm[i] = stored.spacingMm[from];
    const auto at = static_cast<std::size_t>(i);
    stride[at] = fileStride[static_cast<std::size_t>(from)];
    if (!orientation.reversed[i]) continue;
    first += (grid.dims[i] - 1) * stride[at];
    stride[at] = -stride[at];
  }

  const std::size_t size = sizeOf(type);
  std::vector<std::byte> turned = allocateVoxels("turning the axes", voxels.size());
  std::byte* to = turned.data();
  const auto perStep = static_cast<std::ptrdiff_t>(grid.voxelCount());
  for (int step = 0; step < timeSteps; ++step)
    for (int z = 0; z < grid.dims.z; ++z)
      for (int y = 0; y < grid.dims.y; ++y) {
        std::ptrdiff_t from = step * perStep + first + z * stride[2] + y * stride[1];
        for (int x = 0; x < grid.dims.x; ++x, from += stride[0], to += size)
          std::memcpy(to, voxels.data() + from * static_cast<std::ptrdiff_t>(size), size);
      }
  return turned;
}

} // namespace volmark
