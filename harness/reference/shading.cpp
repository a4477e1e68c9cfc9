#include "reference/shading.h"

#include <algorithm>
#include <cmath>

namespace volmark::reference {

namespace {

constexpr double kSmallestGradient = 1e-6;

glm::dvec3 highlight(const Arriving& light, const glm::dvec3& n, const glm::dvec3& l, const glm::dvec3& v) {
  const glm::dvec3 sum = l + v;
  const double length = glm::length(sum);
  if (glm::dot(n, l) <= 0 || length == 0) return glm::dvec3(0);
  return 0.3 * light.color * std::pow(std::max(glm::dot(n, sum) / length, 0.0), 32);
}

double toTheFifth(double x) {
  return x * x * x * x * x;
}

/// Burley's diffuse term and a GGX lobe; the lobe's 1/pi is left out, as the light is given in units of pi.
Response respondAsGgx(const Arriving& light, const glm::dvec3& n, const glm::dvec3& l, const glm::dvec3& v) {
  constexpr double kRoughness = 0.5;
  constexpr double kFacing = 0.04; // Fresnel reflectance at normal incidence
  const double nl = glm::dot(n, l);
  if (nl <= 0) return {glm::dvec3(light.ambient), glm::dvec3(0)};
  const glm::dvec3 h = glm::normalize(l + v);
  const double nv = std::max(glm::dot(n, v), 0.0);
  const double nh = glm::dot(n, h);
  const double lh = glm::dot(l, h);

  const double grazing = 0.5 + 2 * kRoughness * lh * lh - 1;
  const double diffuse = (1 + grazing * toTheFifth(1 - nl)) * (1 + grazing * toTheFifth(1 - nv));

  const double a2 = std::pow(kRoughness, 4);
  const double distribution = a2 / std::pow(nh * nh * (a2 - 1) + 1, 2);
  const double visibility =
      0.5 / (nl * std::sqrt(nv * nv * (1 - a2) + a2) + nv * std::sqrt(nl * nl * (1 - a2) + a2) + 1e-5);
  const double fresnel = kFacing + (1 - kFacing) * toTheFifth(1 - lh);
  return {light.ambient + (1 - light.ambient) * light.color * (diffuse * nl),
          light.color * (distribution * visibility * fresnel * nl)};
}

} // namespace

Arriving arrivingAt(const glm::dvec3& place, const Light& light, const Grid& grid, const glm::dvec3& toEye) {
  if (light.headlight) return {toEye, light.color, light.ambient};
  if (!light.spot) return {light.direction, light.color, light.ambient};
  return {glm::normalize(light.position(grid) - place), light.color, light.ambient};
}

Response respond(ShadingModel model, const Arriving& light, const glm::dvec3& normal, const glm::dvec3& toEye) {
  const glm::dvec3 n = glm::dot(normal, toEye) < 0 ? -normal : normal;
  const glm::dvec3& l = light.from;
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
  case ShadingModel::ggx: return respondAsGgx(light, n, l, toEye);
  }
  return {};
}

Response respondToGradient(ShadingModel model, const Arriving& light, const glm::dvec3& gradient,
                           const glm::dvec3& toEye) {
  const double length = glm::length(gradient);
  if (length < kSmallestGradient) return {};
  return respond(model, light, -gradient / length, toEye);
}

} // namespace volmark::reference
