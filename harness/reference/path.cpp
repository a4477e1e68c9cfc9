#include "reference/path.h"

#include <algorithm>
#include <limits>

namespace volmark::reference {

namespace {

/// Narrows the path to where dot(normal, p) >= offset. False if nothing is left.
bool keepHalfSpace(const glm::dvec3& normal, double offset, Path& path) {
  const double height = glm::dot(normal, path.origin) - offset;
  const double slope = glm::dot(normal, path.direction);
  if (slope == 0) return height >= 0;
  const double crossing = -height / slope;
  if (slope < 0) {
    path.exit = std::min(path.exit, crossing);
  } else if (crossing > path.entry) {
    path.entry = crossing;
    path.entryNormal = -glm::normalize(normal);
  }
  return path.entry <= path.exit;
}

/// Cuts a path to the box, then to the planes. False if nothing is left. The box is six half spaces; a side's offset is
/// minus half the extent.
bool cut(const Grid& grid, std::span<const ClippingPlane> planes, Path& path) {
  for (int axis = 0; axis < 3; ++axis) {
    const double halfExtent = 0.5 * (grid.dims[axis] - 1) * grid.spacingMm[axis];
    glm::dvec3 side(0);
    side[axis] = 1;
    if (!keepHalfSpace(side, -halfExtent, path) || !keepHalfSpace(-side, -halfExtent, path)) return false;
  }
  path.boxEntry = path.entry;
  return std::all_of(planes.begin(), planes.end(),
                     [&](const ClippingPlane& plane) { return keepHalfSpace(plane.normal, plane.offset, path); });
}

} // namespace

std::optional<Path> pathBetween(const Grid& grid, std::span<const ClippingPlane> planes, const glm::dvec3& from,
                                const glm::dvec3& to) {
  const double length = glm::distance(from, to);
  const glm::dvec3 direction = (to - from) / length;
  Path path{.origin = from, .direction = direction, .cosine = 1, .entry = 0, .exit = length, .entryNormal = -direction};
  if (!cut(grid, planes, path)) return std::nullopt;
  return path;
}

std::optional<Path> pathThroughPixel(const Grid& grid, std::span<const ClippingPlane> planes, const View& view, int x,
                                     int y, int width, int height) {
  // Interpolate the frustum's tangents at the pixel's centre; row 0 is at the top.
  const double across = (x + 0.5) / width;
  const double down = (y + 0.5) / height;
  const double tangentX = (1 - across) * view.frustum.left + across * view.frustum.right;
  const double tangentY = (1 - down) * view.frustum.up + down * view.frustum.down;
  const glm::dvec3 toPixel = view.pose.forward + tangentX * view.pose.right + tangentY * view.pose.up;

  Path path;
  path.origin = view.pose.position;
  path.cosine = 1 / glm::length(toPixel);
  path.direction = toPixel * path.cosine;
  path.entry = 0;
  path.exit = std::numeric_limits<double>::infinity();
  path.entryNormal = -path.direction;

  if (!cut(grid, planes, path)) return std::nullopt;
  return path;
}

} // namespace volmark::reference
