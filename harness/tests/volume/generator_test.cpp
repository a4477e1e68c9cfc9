#include "volume/generators/fields.h"
#include "volume/generators/generator.h"
#include "volume/volume_files.h"

#include <cmath>
#include <numbers>
#include <random>

namespace volmark::test {
namespace {

GeneratorSettings settingsOf(const std::string& name, int size = 16, ScalarType type = ScalarType::uint8) {
  return {.name = name, .dims = glm::ivec3(size), .type = type};
}

class Generators : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(All, Generators, testing::ValuesIn(generatorNames()),
                         [](const auto& test) { return test.param; });

TEST_P(Generators, GradientIsTheDerivativeOfTheValue) {
  const auto field = makeField(settingsOf(GetParam()));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> inCube(-1, 1);
  constexpr double h = 1e-6;
  double steepest = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 p(inCube(random), inCube(random), inCube(random));
    const glm::dvec3 gradient = field->gradient(p);
    steepest = std::max(steepest, glm::length(gradient));
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0.0);
      step[axis] = h;
      const double difference = (field->value(p + step) - field->value(p - step)) / (2 * h);
      // Third derivatives reach 60 / width^3, 2e6, within soft edges.
      ASSERT_NEAR(gradient[axis], difference, 1e-6) << p.x << " " << p.y << " " << p.z << " axis " << axis;
    }
  }
  EXPECT_GT(steepest, 1);
}

TEST_P(Generators, ValuesLieBetween0And1AndUseMostOfIt) {
  const auto volume = generateVolume(settingsOf(GetParam(), 48, ScalarType::float32));
  EXPECT_GE(volume->dataRange().minimum, 0);
  EXPECT_LE(volume->dataRange().minimum, 0.05);
  EXPECT_LE(volume->dataRange().maximum, 1);
  EXPECT_GE(volume->dataRange().maximum, 0.85);
}

TEST_P(Generators, VoxelsAreTheFieldTimesTheUnit) {
  for (const auto type :
       {ScalarType::int8, ScalarType::uint8, ScalarType::int16, ScalarType::uint16, ScalarType::float32}) {
    GeneratorSettings settings = settingsOf(GetParam(), 1, type);
    settings.dims = {9, 7, 5};
    settings.spacingMm = {1, 2, 3};
    const auto volume = generateVolume(settings);
    const auto field = makeField(settings);
    const double tolerance = type == ScalarType::float32 ? 1e-7 : 0.5 + 1e-9;
    EXPECT_EQ(volume->grid().spacingMm, settings.spacingMm);
    for (int k = 0; k < 5; ++k)
      for (int j = 0; j < 7; ++j)
        for (int i = 0; i < 9; ++i) {
          const glm::dvec3 p(-1 + 2 * i / 8.0, -1 + 2 * j / 6.0, -1 + 2 * k / 4.0);
          ASSERT_NEAR(volume->value(i, j, k), field->value(p) * voxelUnit(settings), tolerance);
        }
  }
}

TEST_P(Generators, OnlyVoxelOfAnAxisLiesInTheMiddle) {
  GeneratorSettings settings = settingsOf(GetParam(), 1, ScalarType::float32);
  settings.dims = {3, 1, 1};
  const auto volume = generateVolume(settings);
  const auto field = makeField(settings);
  EXPECT_EQ(volume->value(0, 0, 0), static_cast<float>(field->value({-1, 0, 0})));
  EXPECT_EQ(volume->value(1, 0, 0), static_cast<float>(field->value({0, 0, 0})));
}

TEST(Generator, RefusesUnknownNamesAndValues) {
  expectInputError([] { makeField(settingsOf("marschner_lob")); }, "did you mean \"marschner_lobb\"?");
  GeneratorSettings settings = settingsOf("marschner_lobb");
  settings.parameters = {{"f_n", 6}};
  expectInputError([&] { makeField(settings); },
                   "generator marschner_lobb: unknown parameter \"f_n\", did you mean \"f_m\"?");
  settings.parameters = {{"f_m", std::nan("")}};
  expectInputError([&] { makeField(settings); }, "generator marschner_lobb: f_m: found");
  settings.parameters = {{"alpha", -1}};
  expectInputError([&] { makeField(settings); }, "alpha: found -1");
  settings.parameters = {};
  settings.dims = {4, 0, 4};
  expectInputError([&] { generateVolume(settings); }, "at least 1");
  settings.dims = glm::ivec3(2000000000);
  expectInputError([&] { generateVolume(settings); }, "generator marschner_lobb");
}

TEST(Generator, DocumentsEveryParameter) {
  EXPECT_EQ(generatorDocumentation("marschner_lobb").size(), 2u);
  EXPECT_EQ(generatorDocumentation("nested_ellipsoids").size(), 2u);
  for (const std::string& name : generatorNames())
    for (const std::string& line : generatorDocumentation(name))
      EXPECT_EQ(line.find('\n'), std::string::npos);
}

TEST(MarschnerLobbField, IsThePublishedFormula) {
  constexpr double pi = std::numbers::pi;
  const MarschnerLobb field(6, 0.25);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> inCube(-1, 1);
  for (int i = 0; i < 10000; ++i) {
    const glm::dvec3 p(inCube(random), inCube(random), inCube(random));
    const double radial = std::cos(2 * pi * 6 * std::cos(pi * std::hypot(p.x, p.y) / 2));
    EXPECT_NEAR(field.value(p), (1 - std::sin(pi * p.z / 2) + 0.25 * (1 + radial)) / (2 * (1 + 0.25)), 2e-15);
  }
}

TEST(QuarterTurns, AgreeWithTheLibrary) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> turns(-50, 50);
  for (int i = 0; i < 10000; ++i) {
    const double t = turns(random);
    EXPECT_NEAR(sineOfQuarterTurns(t), std::sin(t * std::numbers::pi / 2), 3e-14);
    EXPECT_NEAR(cosineOfQuarterTurns(t), std::cos(t * std::numbers::pi / 2), 3e-14);
    const double square = std::pow(sineOfQuarterTurns(t), 2) + std::pow(cosineOfQuarterTurns(t), 2);
    EXPECT_NEAR(square, 1, 4e-16);
  }
  for (int t = -9; t <= 9; ++t)
    EXPECT_EQ(sineOfQuarterTurns(t), t % 2 == 0 ? 0 : (((t % 4) + 4) % 4 == 1 ? 1 : -1));
}

TEST(NestedEllipsoidsField, HasItsPlateaus) {
  const auto field = makeField(settingsOf("nested_ellipsoids"));
  const auto expectPlateau = [&](const glm::dvec3& p, double value) {
    EXPECT_DOUBLE_EQ(field->value(p), value);
    EXPECT_EQ(field->gradient(p), glm::dvec3(0.0));
  };
  expectPlateau({0.9, 0.9, 0.9}, NestedEllipsoids::kAir);
  expectPlateau({0.72, 0, 0}, NestedEllipsoids::kSkin);
  expectPlateau({0.64, 0, 0}, NestedEllipsoids::kBone);
  expectPlateau({0, 0, 0}, NestedEllipsoids::kBrain);
  expectPlateau({0.2, 0.1, 0.1}, NestedEllipsoids::kFluid);
  expectPlateau({0, -0.5, -0.3}, NestedEllipsoids::kAir);
  // Half-way between two plateaus on the ellipsoid itself.
  EXPECT_NEAR(field->value({0.76, 0, 0}), (NestedEllipsoids::kAir + NestedEllipsoids::kSkin) / 2, 1e-12);
  EXPECT_NEAR(field->value({0, 0, 0.82}), (NestedEllipsoids::kSkin + NestedEllipsoids::kBone) / 2, 1e-12);
}

TEST(NestedEllipsoidsField, FacesOfTheCubeAreAir) {
  GeneratorSettings settings = settingsOf("nested_ellipsoids");
  settings.parameters = {{"edge_width", 0.05}};
  const auto field = makeField(settings);
  for (double u = -1; u <= 1; u += 0.05)
    for (double v = -1; v <= 1; v += 0.05)
      for (const double side : {-1.0, 1.0})
        for (const glm::dvec3 p : {glm::dvec3(side, u, v), glm::dvec3(u, side, v), glm::dvec3(u, v, side)})
          ASSERT_EQ(field->value(p), NestedEllipsoids::kAir);
}

TEST(Generator, BytesAreTheSameEverywhere) {
  const auto identity = [](const std::string& name, ScalarType type) {
    return generateVolume(settingsOf(name, 64, type))->identity();
  };
  EXPECT_EQ(identity("marschner_lobb", ScalarType::uint8), "26892d5d4245b9e78b0f198202083d37");
  EXPECT_EQ(identity("marschner_lobb", ScalarType::float32), "3f9c4080e41f8941b7ddbb97fb65448e");
  EXPECT_EQ(identity("nested_ellipsoids", ScalarType::int16), "12e6545f514c39ca567dd4a1861ad591");
  EXPECT_EQ(identity("nested_ellipsoids", ScalarType::float32), "3fe86a23ef4d6ff6e0666a7b9cb0d292");
}

} // namespace
} // namespace volmark::test
