#include "volume/generators/painting.h"

namespace volmark {

namespace {

std::vector<Layer> headLayers(double edgeWidth, double boneThickness) {
  const auto layer = [&](const glm::dvec3& centre, const glm::dvec3& semiAxes, double plateau) {
    return Layer{std::make_shared<Ellipsoid>(centre, semiAxes, edgeWidth), plateau};
  };
  const glm::dvec3 skull(0.68, 0.86, 0.82);
  const double sinusWall = 0.05;
  const glm::dvec3 sinusCentre(0.0, -0.5, -0.3);
  const glm::dvec3 sinus(0.17, 0.15, 0.2);
  return {layer({0, 0, 0}, {0.76, 0.94, 0.9}, NestedEllipsoids::kSkin),
          layer({0, 0, 0}, skull, NestedEllipsoids::kBone),
          layer({0, 0, 0}, skull - boneThickness, NestedEllipsoids::kBrain),
          layer({-0.2, 0.1, 0.1}, {0.1, 0.3, 0.2}, NestedEllipsoids::kFluid),
          layer({0.2, 0.1, 0.1}, {0.1, 0.3, 0.2}, NestedEllipsoids::kFluid),
          layer(sinusCentre, sinus + sinusWall, NestedEllipsoids::kBone),
          layer(sinusCentre, sinus, NestedEllipsoids::kAir)};
}

} // namespace

NestedEllipsoids::NestedEllipsoids(double edgeWidth, double boneThickness)
    : Painting(headLayers(edgeWidth, boneThickness)) {
}

} // namespace volmark
