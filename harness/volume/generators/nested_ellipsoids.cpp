#include "volume/generators/fields.h"

#include <algorithm>
#include <cmath>

namespace volmark {

namespace {

/// From 0 to 1 over [0,1] with zero first and second derivatives at both ends.
double smoothStep(double t) {
  return t * t * t * (t * (6 * t - 15) + 10);
}
double smoothStepSlope(double t) {
  return 30 * t * t * (t - 1) * (t - 1);
}

} // namespace

NestedEllipsoids::NestedEllipsoids(double edgeWidth, double boneThickness) : m_edgeWidth(edgeWidth) {
  const glm::dvec3 skull(0.68, 0.86, 0.82);
  const double sinusWall = 0.05;
  const glm::dvec3 sinusCentre(0.0, -0.5, -0.3);
  const glm::dvec3 sinus(0.17, 0.15, 0.2);
  m_layers = {{{0, 0, 0}, {0.76, 0.94, 0.9}, kSkin},
              {{0, 0, 0}, skull, kBone},
              {{0, 0, 0}, skull - boneThickness, kBrain},
              {{-0.2, 0.1, 0.1}, {0.1, 0.3, 0.2}, kFluid},
              {{0.2, 0.1, 0.1}, {0.1, 0.3, 0.2}, kFluid},
              {sinusCentre, sinus + sinusWall, kBone},
              {sinusCentre, sinus, kAir}};
}

NestedEllipsoids::Share NestedEllipsoids::shareOf(const Layer& layer, const glm::dvec3& p) const {
  // 1 on the ellipsoid; its gradient isn't defined at the centre, where the share is constant.
  const glm::dvec3 offset = p - layer.centre;
  const glm::dvec3 scaled = offset / layer.semiAxes;
  const double radius = std::sqrt(scaled.x * scaled.x + scaled.y * scaled.y + scaled.z * scaled.z);
  const double perRadius = std::min({layer.semiAxes.x, layer.semiAxes.y, layer.semiAxes.z}) / m_edgeWidth;
  const double t = (1 - radius) * perRadius + 0.5;
  if (t <= 0) return {0.0};
  if (t >= 1) return {1.0};
  const glm::dvec3 radiusGradient = scaled / layer.semiAxes / radius;
  return {smoothStep(t), -smoothStepSlope(t) * perRadius * radiusGradient};
}

double NestedEllipsoids::value(const glm::dvec3& p) const {
  double value = kAir;
  for (const Layer& layer : m_layers)
    value += (layer.plateau - value) * shareOf(layer, p).value;
  return value;
}

glm::dvec3 NestedEllipsoids::gradient(const glm::dvec3& p) const {
  double value = kAir;
  glm::dvec3 gradient(0.0);
  for (const Layer& layer : m_layers) {
    const Share share = shareOf(layer, p);
    gradient = (1 - share.value) * gradient + (layer.plateau - value) * share.gradient;
    value += (layer.plateau - value) * share.value;
  }
  return gradient;
}

} // namespace volmark
