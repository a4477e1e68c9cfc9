#include "reference/shading.h"

#include <gtest/gtest.h>

namespace volmark::reference {

namespace {

constexpr double kTiny = 1e-14;
const glm::dvec3 kColor(0.8, 0.4, 0.2);
const glm::dvec3 kEye(0, 0, 1);

Light lightFrom(const glm::dvec3& direction) {
  Light light;
  light.headlight = false;
  light.direction = glm::normalize(direction);
  return light;
}

void expectColor(const glm::dvec3& found, const glm::dvec3& expected) {
  EXPECT_LT(glm::distance(found, expected), kTiny) << found.x << " " << found.y << " " << found.z;
}

Arriving arriving(const Light& light, const glm::dvec3& toEye) {
  return arrivingAt(glm::dvec3(0), light, Grid{}, toEye);
}

Response respond(ShadingModel model, const Light& light, const glm::dvec3& normal, const glm::dvec3& toEye) {
  return respond(model, arriving(light, toEye), normal, toEye);
}

} // namespace

TEST(Shading, NoneKeepsTheColour) {
  expectColor(respond(ShadingModel::none, lightFrom({1, 1, 1}), {0, 0, 1}, kEye).lit(kColor), kColor);
}

TEST(Shading, HeadlightOnAFacingSurface) {
  const Light light;
  expectColor(respond(ShadingModel::lambert, light, {0, 0, 1}, kEye).lit(kColor), kColor);
  expectColor(respond(ShadingModel::phong, light, {0, 0, 1}, kEye).lit(kColor), kColor + 0.3);
  // t = 1: warm plus the highlight.
  expectColor(respond(ShadingModel::gooch, light, {0, 0, 1}, kEye).lit(kColor),
              glm::dvec3(0.4, 0.4, 0) + 0.5 * kColor + 0.3);
}

TEST(Shading, NormalsAreTurnedToTheEye) {
  for (const ShadingModel model : {ShadingModel::lambert, ShadingModel::phong, ShadingModel::gooch}) {
    const Light light = lightFrom({1, 2, 3});
    const glm::dvec3 normal = glm::normalize(glm::dvec3(0.3, -0.2, 0.7));
    expectColor(respond(model, light, normal, kEye).lit(kColor), respond(model, light, -normal, kEye).lit(kColor));
  }
}

TEST(Shading, LightFromBehindLeavesAmbient) {
  Light light = lightFrom({0, 0, -1});
  light.ambient = 0.2;
  expectColor(respond(ShadingModel::lambert, light, {0, 0, 1}, kEye).lit(kColor), 0.2 * kColor);
  expectColor(respond(ShadingModel::phong, light, {0, 0, 1}, kEye).lit(kColor), 0.2 * kColor);
  expectColor(respond(ShadingModel::gooch, light, {0, 0, 1}, kEye).lit(kColor), glm::dvec3(0, 0, 0.4) + 0.25 * kColor);
}

TEST(Shading, ObliqueLightByHand) {
  // n.l = 0.6; h = (0.8, 0, 1.6) / sqrt(3.2), so n.h = sqrt(0.8).
  Light light = lightFrom({0.8, 0, 0.6});
  light.color = {1, 0.5, 0.25};
  const glm::dvec3 lambert = kColor * (0.1 + 0.9 * light.color * 0.6);
  const glm::dvec3 highlight = 0.3 * light.color * std::pow(0.8, 16);
  expectColor(respond(ShadingModel::lambert, light, {0, 0, 1}, kEye).lit(kColor), lambert);
  expectColor(respond(ShadingModel::phong, light, {0, 0, 1}, kEye).lit(kColor), lambert + highlight);
  const glm::dvec3 cool = glm::dvec3(0, 0, 0.4) + 0.25 * kColor;
  const glm::dvec3 warm = glm::dvec3(0.4, 0.4, 0) + 0.5 * kColor;
  expectColor(respond(ShadingModel::gooch, light, {0, 0, 1}, kEye).lit(kColor), 0.2 * cool + 0.8 * warm + highlight);
}

TEST(Shading, GgxByHand) {
  // Light, eye and normal in one line: d = 1, D = 1/a2, V = 0.25 (with 1e-5 in the sum), F = 0.04.
  const double lobe = 16 * 0.5 / (2 + 1e-5) * 0.04;
  expectColor(respond(ShadingModel::ggx, Light{}, {0, 0, 1}, kEye).lit(kColor), kColor + lobe);
  // Light from behind leaves the ambient share.
  Light behind = lightFrom({0, 0.6, -0.8});
  behind.ambient = 0.2;
  expectColor(respond(ShadingModel::ggx, behind, {0, 0, 1}, kEye).lit(kColor), 0.2 * kColor);
}

// Helmholtz: without the cosine, light and eye can change places.
TEST(Shading, GgxIsReciprocal) {
  Light light = lightFrom({0.5, 0.3, 0.7});
  light.ambient = 0;
  const glm::dvec3 eye = glm::normalize(glm::dvec3(-0.2, 0.6, 0.4));
  const glm::dvec3 there = respond(ShadingModel::ggx, light, {0, 0, 1}, eye).lit(kColor) / light.direction.z;
  const Light back{.headlight = false, .direction = eye, .ambient = 0};
  const glm::dvec3 again = respond(ShadingModel::ggx, back, {0, 0, 1}, light.direction).lit(kColor) / eye.z;
  expectColor(there, again);
}

// Lambert never gives more than it gets: its colour stays between the ambient share and the whole.
TEST(Shading, LambertKeepsWithinItsEnergy) {
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(std::cos(i), std::sin(2 * i), std::cos(3 * i)));
    const glm::dvec3 lit = respond(ShadingModel::lambert, lightFrom({std::sin(i), 1, 0.5}), normal, kEye).lit(kColor);
    EXPECT_TRUE(glm::all(glm::lessThanEqual(lit, kColor + kTiny)));
    EXPECT_TRUE(glm::all(glm::greaterThanEqual(lit, 0.1 * kColor - kTiny)));
  }
}

TEST(Shading, VanishingGradientsLeaveTheColour) {
  const Light light = lightFrom({1, 0, 0});
  expectColor(respondToGradient(ShadingModel::phong, arriving(light, kEye), {0, 0, 0.9e-6}, kEye).lit(kColor), kColor);
  expectColor(respondToGradient(ShadingModel::phong, arriving(light, kEye), {0, 0, 1.1e-6}, kEye).lit(kColor),
              respond(ShadingModel::phong, light, {0, 0, -1}, kEye).lit(kColor));
}

} // namespace volmark::reference
