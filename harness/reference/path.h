// What a pixel's ray sees of the volume: the part within the box of voxel centres and all clipping planes.
#pragma once

#include "volmark/scene.h"

#include <optional>
#include <span>

namespace volmark::reference {

/// Points are origin + t * direction, t in world units, boxEntry <= entry <= t <= exit.
struct Path {
  glm::dvec3 origin;
  glm::dvec3 direction;   ///< normalised
  double cosine;          ///< of the angle to the view direction
  double entry;           ///< >= boxEntry, behind the clipping planes
  double exit;            ///< equal to the entry in a box of no thickness
  glm::dvec3 entryNormal; ///< of the side or plane entered by, to the eye; -direction if the eye is inside
  double boxEntry = 0;    ///< into the box, >= 0: where the grid of samples starts

  glm::dvec3 at(double t) const { return origin + t * direction; }
};

/// The ray from one point to another one. Nothing if it meets nothing of the volume.
std::optional<Path> pathBetween(const Grid& grid, std::span<const ClippingPlane> planes, const glm::dvec3& from,
                                const glm::dvec3& to);

/// The ray through the centre of pixel (x, y) of a width*height picture, y down. Nothing if it misses.
std::optional<Path> pathThroughPixel(const Grid& grid, std::span<const ClippingPlane> planes, const View& view, int x,
                                     int y, int width, int height);

} // namespace volmark::reference
