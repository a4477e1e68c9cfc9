#include "volmark/view.h"

#include <cmath>

namespace volmark {

Pose Pose::lookAt(const glm::dvec3& position, const glm::dvec3& target, const glm::dvec3& up) {
  Pose pose;
  pose.position = position;
  pose.forward = glm::normalize(target - position);
  pose.right = glm::normalize(glm::cross(pose.forward, up));
  pose.up = glm::cross(pose.right, pose.forward);
  return pose;
}

Frustum Frustum::symmetric(double verticalFovDegrees, int width, int height) {
  const double vertical = std::tan(glm::radians(verticalFovDegrees) / 2);
  const double horizontal = vertical * width / height;
  return {-horizontal, horizontal, -vertical, vertical};
}

Ray rayThroughPixel(const View& view, int x, int y, int width, int height) {
  const Frustum& f = view.frustum;
  const double u = f.left + (f.right - f.left) * (x + 0.5) / width;
  const double v = f.up + (f.down - f.up) * (y + 0.5) / height;
  const glm::dvec3 direction = view.pose.forward + u * view.pose.right + v * view.pose.up;
  const double length = glm::length(direction);
  return {view.pose.position, direction / length, 1 / length};
}

} // namespace volmark
