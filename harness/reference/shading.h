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

/// `normal` is normalised and may point either way; `toEye` is normalised.
Response respond(ShadingModel model, const Light& light, const glm::dvec3& normal, const glm::dvec3& toEye);

/// With the normal of a gradient (per world unit); below a length of 1e-6 the colour is left as it is.
Response respondToGradient(ShadingModel model, const Light& light, const glm::dvec3& gradient, const glm::dvec3& toEye);

} // namespace volmark::reference
