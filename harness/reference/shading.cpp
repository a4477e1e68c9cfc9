#include "reference/shading.h"

#include <algorithm>
#include <cmath>

namespace volmark::reference {

namespace {

constexpr double kSmallestGradient = 1e-6;

glm::dvec3 highlight(const Light& light, const glm::dvec3& n, const glm::dvec3& l, const glm::dvec3& v) {
  const glm::dvec3 sum = l + v;
  const double length = glm::length(sum);
  if (glm::dot(n, l) <= 0 || length == 0) return glm::dvec3(0);
  return 0.3 * light.color * std::pow(std::max(glm::dot(n, sum) / length, 0.0), 32);
}

} // namespace

Response respond(ShadingModel model, const Light& light, const glm::dvec3& normal, const glm::dvec3& toEye) {
  const glm::dvec3 n = glm::dot(normal, toEye) < 0 ? -normal : normal;
  const glm::dvec3 l = light.headlight ? toEye : light.direction;
  const double cosine = glm::dot(n, l);
  const glm::dvec3 lambert = light.ambient + (1 - light.ambient) * light.color * std::max(cosine, 0.0);
  switch (model) {
  case ShadingModel::none: return {};
  case ShadingModel::lambert: return {lambert, glm::dvec3(0)};
  case ShadingModel::phong: return {lambert, highlight(light, n, l, toEye)};
  case ShadingModel::gooch: {
    const double warmth = (1 + cosine) / 2;
    const glm::dvec3 tone = (1 - warmth) * glm::dvec3(0, 0, 0.4) + warmth * glm::dvec3(0.4, 0.4, 0);
    return {glm::dvec3((1 - warmth) * 0.25 + warmth * 0.5), tone + highlight(light, n, l, toEye)};
  }
  }
  return {};
}

Response respondToGradient(ShadingModel model, const Light& light, const glm::dvec3& gradient,
                           const glm::dvec3& toEye) {
  const double length = glm::length(gradient);
  if (length < kSmallestGradient) return {};
  return respond(model, light, -gradient / length, toEye);
}

} // namespace volmark::reference
