// Poses and views: where a picture is taken from.
#pragma once

#include <glm/glm.hpp>

namespace volmark {

/// A camera's place and orthonormal axes in world space (right-handed: right x up = -forward).
struct Pose {
  glm::dvec3 position{0, 0, 1};
  glm::dvec3 right{1, 0, 0};
  glm::dvec3 up{0, 1, 0};
  glm::dvec3 forward{0, 0, -1};

  /// Looks from `position` at `target`; `up` need not be orthogonal but must not be parallel to the view.
  static Pose lookAt(const glm::dvec3& position, const glm::dvec3& target, const glm::dvec3& up = {0, 1, 0});
};

/// Signed tangents of the frustum's sides: left < right, down < up. Symmetric frusta have left = -right.
struct Frustum {
  double left = -1, right = 1, down = -1, up = 1;

  /// Square pixels: the horizontal tangents follow from the aspect ratio.
  static Frustum symmetric(double verticalFovDegrees, int width, int height);
};

/// One eye. `layer` is the array layer of the output that it is drawn to.
struct View {
  Pose pose;
  Frustum frustum;
  int layer = 0;
};

/// A ray through the centre of pixel (x, y) of a width*height picture, y down. `direction` is normalised;
/// the distance along the view direction of a point at ray parameter t is t * cosine.
struct Ray {
  glm::dvec3 origin;
  glm::dvec3 direction;
  double cosine;
};
Ray rayThroughPixel(const View& view, int x, int y, int width, int height);

} // namespace volmark
