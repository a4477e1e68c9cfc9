#include "volume/generators/portable_math.h"
#include "volume/generators/tubes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace volmark::test {
namespace {

TreeSettings freeTree() {
  return {.root = {0, 0, 0},
          .direction = {0, 0, 1},
          .radius = 0.1,
          .length = 1,
          .generations = 8,
          .centre = {0, 0, 0},
          .semiAxes = glm::dvec3(1000.0), // no wall
          .seed = 5};
}

TEST(Tubes, AreHalfOnTheirSurface) {
  const Tubes tube({{{-0.5, 0, 0}, {0.5, 0, 0}, 0.2}}, 0.05);
  EXPECT_NEAR(tube.value({0.1, 0.2, 0}), 0.5, 1e-12);
  EXPECT_NEAR(tube.value({-0.3, 0.12, 0.16}), 0.5, 1e-12);
  EXPECT_NEAR(tube.value({0.7, 0, 0}), 0.5, 1e-12); // round ends
  EXPECT_NEAR(tube.value({-0.5 - 0.12, 0, -0.16}), 0.5, 1e-12);
  EXPECT_EQ(tube.value({0.2, 0.1, 0}), 1);
  EXPECT_EQ(tube.value({0.2, 0.25, 0}), 0);
  EXPECT_NEAR(glm::length(tube.gradient({0.1, 0.2, 0})), 1.875 / 0.05, 1e-9); // slope of the smooth step
}

TEST(Tubes, WithoutLengthAreBalls) {
  const Tubes ball({{{0.1, 0.1, 0.1}, {0.1, 0.1, 0.1}, 0.3}}, 0.01);
  EXPECT_NEAR(ball.value({0.1, 0.4, 0.1}), 0.5, 1e-9);
  EXPECT_NEAR(ball.value({0.1, 0.1, -0.2}), 0.5, 1e-9);
  EXPECT_EQ(ball.value({0.1, 0.1, 0.1}), 1);
}

class SomeTubes : public testing::Test {
protected:
  static constexpr double kEdgeWidth = 0.2;
  static glm::dvec3 point(std::uint32_t i) {
    return {2 * randomUnit(1, i, 0) - 1, 2 * randomUnit(1, i, 1) - 1, 2 * randomUnit(1, i, 2) - 1};
  }
  const std::vector<Tube> m_tubes = {{{-0.7, 0, 0.1}, {0.2, 0.1, 0.3}, 0.3},
                                     {{0.2, 0.1, 0.3}, {0.7, 0.6, -0.4}, 0.2},
                                     {{0, -0.5, 0}, {0, -0.5, 0}, 0.35},
                                     {{-0.5, 0.6, -0.7}, {0.4, 0.5, -0.6}, 0.05}};
  const Tubes m_field{m_tubes, kEdgeWidth};
};

TEST_F(SomeTubes, ValueIsThatOfTheTubeThatCoversMost) {
  const auto distance = [](const Tube& tube, const glm::dvec3& p) {
    const double toEnds = std::min(glm::distance(p, tube.start), glm::distance(p, tube.end));
    if (tube.start == tube.end) return toEnds;
    const glm::dvec3 along = glm::normalize(tube.end - tube.start);
    const bool beside = glm::dot(p - tube.start, along) > 0 && glm::dot(p - tube.end, along) < 0;
    return beside ? glm::length(glm::cross(p - tube.start, along)) : toEnds;
  };
  for (std::uint32_t i = 0; i < 20000; ++i) {
    double most = 0;
    for (const Tube& tube : m_tubes) {
      const double d = distance(tube, point(i));
      most = std::max(most, smoothStep(0.5 + (tube.radius * tube.radius - d * d) / (2 * tube.radius * kEdgeWidth)));
    }
    ASSERT_NEAR(m_field.value(point(i)), most, 1e-12);
  }
}

TEST_F(SomeTubes, GradientIsTheDerivativeOfTheValue) {
  constexpr double h = 1e-5;
  int sloped = 0;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const glm::dvec3 gradient = m_field.gradient(point(i));
    sloped += glm::length(gradient) > 0.1;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0.0);
      step[axis] = h;
      const double difference = m_field.value(point(i) + step) - m_field.value(point(i) - step);
      ASSERT_NEAR(gradient[axis], difference / (2 * h), 1e-5);
    }
  }
  EXPECT_GT(sloped, 2000);
}

TEST(Tree, BifurcationsKeepMurraysLaw) {
  const std::vector<Branch> branches = growTree(freeTree());
  ASSERT_EQ(branches.size(), 511u);
  std::vector<std::vector<const Branch*>> children(branches.size());
  for (const Branch& branch : branches)
    if (branch.parent >= 0) children[static_cast<std::size_t>(branch.parent)].push_back(&branch);
  for (std::size_t i = 0; i < branches.size(); ++i) {
    if (i >= 255) {
      EXPECT_TRUE(children[i].empty());
      continue;
    }
    ASSERT_EQ(children[i].size(), 2u);
    double cubes = 0;
    glm::dvec3 pull(0.0);
    const auto direction = [](const Branch& b) { return glm::normalize(b.points.back() - b.points.front()); };
    for (const Branch* child : children[i]) {
      EXPECT_EQ(child->points.front(), branches[i].points.back());
      cubes += std::pow(child->radius, 3);
      pull += std::pow(child->radius, 2) * direction(*child);
    }
    EXPECT_NEAR(cubes / std::pow(branches[i].radius, 3), 1, 1e-13);
    // At Murray's angles, forces in proportion to the squared radii are in balance.
    const glm::dvec3 parent = std::pow(branches[i].radius, 2) * direction(branches[i]);
    EXPECT_LT(glm::length(pull - parent), 1e-12);
  }
}

TEST(Tree, FillsSpaceAndNotAPlane) {
  glm::dvec3 low(1e9);
  glm::dvec3 high(-1e9);
  for (const Branch& branch : growTree(freeTree())) {
    low = glm::min(low, branch.points.back());
    high = glm::max(high, branch.points.back());
  }
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_GT(high[axis] - low[axis], 2) << axis;
}

TEST(VesselTree, IsSparseAndStaysInside) {
  for (const double seed : {1, 2, 3}) {
    GeneratorSettings settings{.name = "vessel_tree", .dims = glm::ivec3(128), .parameters = {{"seed", seed}}};
    const auto volume = generateVolume(settings);
    std::size_t occupied = 0;
    for (int k = 0; k < 128; ++k)
      for (int j = 0; j < 128; ++j)
        for (int i = 0; i < 128; ++i) {
          const double value = volume->value(i, j, k);
          occupied += value >= 127.5;
          const bool onFace = std::min({i, j, k}) == 0 || std::max({i, j, k}) == 127;
          if (onFace) {
            ASSERT_EQ(value, 0) << i << " " << j << " " << k;
          }
        }
    const double share = double(occupied) / std::pow(128, 3);
    RecordProperty("share_of_seed_" + std::to_string(int(seed)), std::to_string(share));
    EXPECT_GT(share, 0.01);
    EXPECT_LT(share, 0.03);
  }
}

} // namespace
} // namespace volmark::test
