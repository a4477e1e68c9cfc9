#include "volume/generators/generator.h"
#include "volume/generators/painting.h"
#include "volume/generators/portable_math.h"
#include "volume/volume_files.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace volmark::test {
namespace {

GeneratorSettings settingsOf(const std::string& name, int size = 16, ScalarType type = ScalarType::uint8) {
  return {.name = name, .dims = glm::ivec3(size), .type = type};
}

bool makesLabels(const std::string& name) {
  return name == "phantom_labels";
}

/// At a point alone; their slices are fast.
bool isSlow(const std::string& name) {
  return name == "noise" || name == "vessel_tree" || name == "phantom";
}

class Generators : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(All, Generators, testing::ValuesIn(generatorNames()),
                         [](const auto& test) { return test.param; });

TEST_P(Generators, GradientIsTheDerivativeOfTheValue) {
  if (makesLabels(GetParam())) return;
  const auto field = makeField(settingsOf(GetParam()));
  const int points = isSlow(GetParam()) ? 2000 : 20000;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> inCube(-1, 1);
  constexpr double h = 1e-6;
  double steepest = 0;
  for (int i = 0; i < points; ++i) {
    const glm::dvec3 p(inCube(random), inCube(random), inCube(random));
    const glm::dvec3 gradient = field->gradient(p);
    steepest = std::max(steepest, glm::length(gradient));
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0.0);
      step[axis] = h;
      // Of fourth order: third derivatives reach 60 / width^3, 2e6, within soft edges.
      const double near = field->value(p + step) - field->value(p - step);
      const double far = field->value(p + 2.0 * step) - field->value(p - 2.0 * step);
      ASSERT_NEAR(gradient[axis], (8 * near - far) / (12 * h), 1e-6)
          << p.x << " " << p.y << " " << p.z << " axis " << axis;
    }
  }
  EXPECT_GT(steepest, 1);
}

TEST_P(Generators, ValuesLieBetween0And1AndUseMostOfIt) {
  if (makesLabels(GetParam())) return;
  const auto volume = generateVolume(settingsOf(GetParam(), 48, ScalarType::float32));
  EXPECT_GE(volume->dataRange().minimum, 0);
  EXPECT_LE(volume->dataRange().minimum, 0.05);
  EXPECT_LE(volume->dataRange().maximum, 1);
  EXPECT_GE(volume->dataRange().maximum, 0.85);
}

TEST_P(Generators, SlicesAreTheValuesBitByBit) {
  const auto field = makeField(settingsOf(GetParam()));
  std::mt19937 random(2);
  std::uniform_real_distribution<double> inCube(-1, 1);
  std::vector<double> xs(17);
  std::vector<double> ys(13);
  std::vector<double> values(xs.size() * ys.size());
  for (int i = 0; i < 10; ++i) {
    for (std::vector<double>* positions : {&xs, &ys}) {
      std::generate(positions->begin(), positions->end(), [&] { return inCube(random); });
      std::sort(positions->begin(), positions->end());
    }
    const double z = inCube(random);
    field->sampleSlice(xs, ys, z, values);
    for (std::size_t j = 0; j < ys.size(); ++j)
      for (std::size_t k = 0; k < xs.size(); ++k)
        ASSERT_EQ(values[j * xs.size() + k], field->value({xs[k], ys[j], z})) << xs[k] << " " << ys[j] << " " << z;
  }
}

TEST_P(Generators, AnyNumberOfThreadsMakesTheSameBytes) {
  const GeneratorSettings settings = settingsOf(GetParam(), 21);
  const std::string one = generateVolume(settings, 1)->identity();
  for (const int threads : {2, 3, 64})
    EXPECT_EQ(generateVolume(settings, threads)->identity(), one) << threads;
}

TEST_P(Generators, ParametersAreDescribed) {
  for (const ParameterDescriptor& parameter : generatorParameters(GetParam())) {
    EXPECT_FALSE(parameter.documentation.empty()) << parameter.name;
    EXPECT_EQ(whyNotAllowed(parameter, parameter.defaultValue), std::nullopt) << parameter.name;
    for (const double limit : {parameter.minimum.value(), parameter.maximum.value()}) {
      GeneratorSettings settings = settingsOf(GetParam(), 5);
      settings.parameters[parameter.name] = limit;
      if (parameter.name == "time_steps") settings.dims = glm::ivec3(2);
      EXPECT_NO_THROW(generateVolume(settings)) << parameter.name << " " << limit;
    }
  }
}

TEST_P(Generators, AnotherSeedIsAnotherVolume) {
  GeneratorSettings settings = settingsOf(GetParam(), 21);
  settings.parameters = {{"seed", 2}};
  try {
    checkGenerator(settings);
  } catch (const InputError&) {
    return; // nothing is random
  }
  EXPECT_NE(generateVolume(settings)->identity(), generateVolume(settingsOf(GetParam(), 21))->identity());
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
  settings.name = "blast_wave";
  settings.parameters = {{"time_steps", 2.5}};
  expectInputError([&] { checkGenerator(settings); },
                   "generator blast_wave: time_steps: found 2.5, allowed: integer 1 to 1000");
  settings.parameters = {{"steps", 2}};
  expectInputError([&] { timeStepsOf(settings); }, "allowed: time_steps, instability, front_width, seed");
  settings.name = "marschner_lobb";
  settings.parameters = {};
  settings.dims = {4, 0, 4};
  expectInputError([&] { generateVolume(settings); }, "at least 1");
  settings.dims = glm::ivec3(2000000000);
  expectInputError([&] { generateVolume(settings); }, "generator marschner_lobb");
}

TEST(Generator, TimeStepsFollowOneAnother) {
  GeneratorSettings settings = settingsOf("blast_wave", 12, ScalarType::float32);
  EXPECT_EQ(generateVolume(settings)->timeSteps(), 30);
  settings.parameters = {{"time_steps", 3}};
  const auto volume = generateVolume(settings);
  ASSERT_EQ(volume->timeSteps(), 3);
  for (int step = 0; step < 3; ++step) {
    const auto field = makeField(settings, step);
    for (int i = 0; i < 12; ++i)
      ASSERT_EQ(volume->value(i, 5, 7, step),
                static_cast<float>(field->value({-1 + 2.0 * i / 11, -1 + 10.0 / 11, -1 + 14.0 / 11})));
  }
  EXPECT_EQ(generateVolume(settingsOf("noise"))->timeSteps(), 1);
}

TEST(Generator, LabelsAreWholeNumbersInEveryType) {
  for (const auto type :
       {ScalarType::int8, ScalarType::uint8, ScalarType::int16, ScalarType::uint16, ScalarType::float32}) {
    const auto volume = generateVolume(settingsOf("phantom_labels", 32, type));
    EXPECT_EQ(volume->dataRange().minimum, 0);
    EXPECT_EQ(volume->dataRange().maximum, 3);
  }
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
  const auto expectIdentity = [](const std::string& name, ScalarType type, const std::string& identity) {
    EXPECT_EQ(generateVolume(settingsOf(name, 64, type))->identity(), identity) << name;
  };
  expectIdentity("marschner_lobb", ScalarType::uint8, "26892d5d4245b9e78b0f198202083d37");
  expectIdentity("marschner_lobb", ScalarType::float32, "3f9c4080e41f8941b7ddbb97fb65448e");
  expectIdentity("nested_ellipsoids", ScalarType::int16, "12e6545f514c39ca567dd4a1861ad591");
  expectIdentity("nested_ellipsoids", ScalarType::float32, "3fe86a23ef4d6ff6e0666a7b9cb0d292");
  expectIdentity("sphere", ScalarType::float32, "0f5689cedaca585595bbe940a6a77f26");
  expectIdentity("torus", ScalarType::float32, "f2d4dfd421fb89e8f2114e8806bca98a");
  expectIdentity("gyroid", ScalarType::float32, "9a3a061b9dabf6df1b4087c599c22902");
  expectIdentity("noise", ScalarType::float32, "a1574fd533924bec99f94442953030fa");
  expectIdentity("vessel_tree", ScalarType::float32, "00a4b39494144a02ae68345ac2734a85");
  expectIdentity("phantom", ScalarType::float32, "a55415d53b9ae721e5bc6bc25f2e574b");
  expectIdentity("phantom_labels", ScalarType::uint8, "c40dcb9ffc835bd21b95364501ca4ba3");
  expectIdentity("blast_wave", ScalarType::float32, "151f8821ff87977088a0e5ab8c3d444e");
}

} // namespace
} // namespace volmark::test
