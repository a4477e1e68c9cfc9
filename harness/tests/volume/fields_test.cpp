// Closed-form fields against their definitions, and the mathematics they are made of against the C library.
#include "volume/generators/fields.h"
#include "volume/generators/portable_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace volmark::test {
namespace {

constexpr double kPi = std::numbers::pi;

class FieldTest : public testing::Test {
protected:
  glm::dvec3 point() { return {m_inCube(m_random), m_inCube(m_random), m_inCube(m_random)}; }
  double angle() { return kPi * m_inCube(m_random); }

private:
  std::mt19937 m_random{2};
  std::uniform_real_distribution<double> m_inCube{-1, 1};
};

TEST_F(FieldTest, MarschnerLobbIsThePublishedFormula) {
  const MarschnerLobb field(6, 0.25);
  for (int i = 0; i < 10000; ++i) {
    const glm::dvec3 p = point();
    const double radial = std::cos(2 * kPi * 6 * std::cos(kPi * std::hypot(p.x, p.y) / 2));
    EXPECT_NEAR(field.value(p), (1 - std::sin(kPi * p.z / 2) + 0.25 * (1 + radial)) / (2 * (1 + 0.25)), 2e-15);
  }
}

TEST_F(FieldTest, SphereAndTorusAreHalfOnTheirSurface) {
  const Sphere sphere(0.7, 0.4);
  const Torus torus(0.6, 0.25, 0.25);
  for (int i = 0; i < 10000; ++i) {
    const double a = angle();
    const double b = angle();
    EXPECT_NEAR(sphere.value(0.7 * glm::dvec3(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b))), 0.5,
                1e-15);
    const double outwards = 0.6 + 0.25 * std::cos(b);
    EXPECT_NEAR(torus.value({outwards * std::cos(a), outwards * std::sin(a), 0.25 * std::sin(b)}), 0.5, 1e-15);
  }
}

/// The length of the way along the gradient to the surface is what the value says.
TEST_F(FieldTest, SphereAndTorusTellTheDistance) {
  const Sphere sphere(0.7, 0.4);
  const Torus torus(0.6, 0.25, 0.25);
  for (const DistanceField* field :
       {static_cast<const DistanceField*>(&sphere), static_cast<const DistanceField*>(&torus)})
    for (int i = 0; i < 10000; ++i) {
      const glm::dvec3 p = point();
      const glm::dvec3 direction = field->direction(p);
      EXPECT_NEAR(glm::length(direction), 1, 1e-12);
      EXPECT_NEAR(field->distance(p - field->distance(p) * direction), 0, 1e-12);
    }
}

TEST_F(FieldTest, DistanceIsCutOffBeyondTheBand) {
  const Sphere sphere(0.7, 0.4);
  for (int i = 0; i < 10000; ++i) {
    const glm::dvec3 p = point();
    const double distance = glm::length(p) - 0.7;
    EXPECT_NEAR(sphere.value(p), std::abs(distance) < 0.4 ? 0.5 - distance / 0.8 : distance < 0 ? 1 : 0, 1e-15);
    EXPECT_EQ(glm::length(sphere.gradient(p)) > 0, std::abs(distance) < 0.4);
  }
  EXPECT_EQ(sphere.value(glm::dvec3(0.0)), 1);
  EXPECT_EQ(sphere.gradient(glm::dvec3(0.0)), glm::dvec3(0.0));
}

TEST_F(FieldTest, GyroidIsItsFormula) {
  const Gyroid field(3);
  for (int i = 0; i < 10000; ++i) {
    const glm::dvec3 p = point();
    const glm::dvec3 t = 3 * kPi * p;
    const double level = std::sin(t.x) * std::cos(t.y) + std::sin(t.y) * std::cos(t.z) + std::sin(t.z) * std::cos(t.x);
    EXPECT_NEAR(field.value(p), 0.5 + level / 3, 2e-15);
    EXPECT_NEAR(field.value(p) + field.value(-p), 1, 1e-15); // its two labyrinths are alike
    EXPECT_NEAR(field.value(p + glm::dvec3(0, 2.0 / 3, 0)), field.value(p), 1e-14);
  }
}

TEST(QuarterTurns, AgreeWithTheLibrary) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> turns(-50, 50);
  for (int i = 0; i < 10000; ++i) {
    const double t = turns(random);
    EXPECT_NEAR(sineOfQuarterTurns(t), std::sin(t * kPi / 2), 3e-14);
    EXPECT_NEAR(cosineOfQuarterTurns(t), std::cos(t * kPi / 2), 3e-14);
    const double square = std::pow(sineOfQuarterTurns(t), 2) + std::pow(cosineOfQuarterTurns(t), 2);
    EXPECT_NEAR(square, 1, 4e-16);
  }
  for (int t = -9; t <= 9; ++t)
    EXPECT_EQ(sineOfQuarterTurns(t), t % 2 == 0 ? 0 : (((t % 4) + 4) % 4 == 1 ? 1 : -1));
}

TEST(Power, AgreesWithTheLibrary) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> exponents(-3, 3);
  for (int i = 0; i < 10000; ++i) {
    const double x = std::exp(exponents(random));
    const double y = exponents(random);
    EXPECT_NEAR(power(x, y) / std::pow(x, y), 1, 2e-15) << x << "^" << y;
  }
  EXPECT_EQ(power(1, 0.4), 1);
  EXPECT_EQ(power(1024, 0), 1);
  EXPECT_EQ(power(4, -2.5), 1.0 / 32);
}

} // namespace
} // namespace volmark::test
