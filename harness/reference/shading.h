// How surfaces and samples are lit: harness/README.md, Shading, written independently of the shaders.
#pragma once

#include "volmark/scene.h"

namespace volmark::reference {

/// Every model is affine in the colour: lit = factor * color + offset. So a whole slab of colours can be lit at once.
struct Response {
  glm::dvec3 factor{1.0};
  glm::dvec3 offset{0.0};

  glm::dvec3 lit(const glm::dvec3& color) const { return factor * color + offset; }
};

/// What arrives at a place.
struct Arriving {
  glm::dvec3 from;  ///< unit vector towards the light
  glm::dvec3 color; ///< of the light, less what shadows keep
  double ambient;
};

/// Without shadows. `toEye` is normalised.
Arriving arrivingAt(const glm::dvec3& place, const Light& light, const Grid& grid, const glm::dvec3& toEye);

/// `normal` is normalised and may point either way; `toEye` is normalised.
Response respond(ShadingModel model, const Arriving& light, const glm::dvec3& normal, const glm::dvec3& toEye);

/// With the normal of a gradient (per world unit); below a length of 1e-6 the colour is left as it is.
Response respondToGradient(ShadingModel model, const Arriving& light, const glm::dvec3& gradient,
                           const glm::dvec3& toEye);

} // namespace volmark::reference
