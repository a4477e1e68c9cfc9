// Occlusion culling changes no pixel on any frame, and draws no block twice.
#include "mesh_shader_isosurface.h"
#include "parts/testing/random_scenes.h"
#include "parts/testing/surface_model.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace volmark::direct_rasterization {
namespace {

using Values = std::vector<std::pair<std::string, ParameterValue>>;
using parts::Drawn;
using parts::Numbers;
using parts::Session;

constexpr int kWidth = 61;
constexpr int kHeight = 53;

#define REQUIRE_MESH_SHADERS()                                                                                         \
  if (!parts::device().facts().meshShader) GTEST_SKIP() << "no mesh shaders"

Session makeSession(const Scene& scene, Values values, bool culling, int views) {
  values.emplace_back("culling", culling);
  return {
      meshShaderIsosurface(), scene, parts::withParameters(meshShaderIsosurface(), values), {kWidth, kHeight, views}};
}

constexpr int kPlateau = 32;

/// Time steps in one volume. Plateaus (uint8): multiples of kPlateau.
std::shared_ptr<const Volume> randomSteps(Numbers& numbers, glm::ivec3 dims, ScalarType type, int steps,
                                          bool plateaus) {
  std::vector<std::byte> all;
  for (int i = 0; i < steps; ++i) {
    const auto step = parts::randomVolume(numbers, dims, type, glm::dvec3(1));
    all.insert(all.end(), step->voxels().begin(), step->voxels().end());
  }
  if (plateaus)
    for (std::byte& voxel : all)
      voxel &= ~std::byte{kPlateau - 1};
  return std::make_shared<Volume>("steps", Grid{dims, {1, 1.2, 0.8}}, type, std::move(all), steps);
}

struct Case {
  std::string name;
  glm::ivec3 dims;
  ScalarType type;
  Values values;
  int views = 1;
  bool hides = true;     ///< regions are small enough to be hidden
  bool plateaus = false; ///< isovalues are voxels: cells beside each other meet in all of a face
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

std::vector<Case> cases() {
  const auto with = [](const char* block, const char* granularity) {
    return Values{{"block", std::string(block)}, {"granularity", std::string(granularity)}};
  };
  return {{"paper", {65, 60, 57}, ScalarType::uint8, {}},
          {"stereo", {47, 33, 40}, ScalarType::uint16, {}, 2},
          {"blocks", {40, 41, 23}, ScalarType::float32, with("4x4x4", "block")},
          {"large_regions", {63, 64, 65}, ScalarType::int16, with("16x4x4", "32x32x32"), 1, false},
          {"plateaus", {48, 45, 47}, ScalarType::uint8, with("8x8x4", "block"), 1, true, true},
          {"smallest", {2, 2, 2}, ScalarType::uint8, {}, 1, false}};
}

double isovalueOf(const Scene& scene, double voxel) {
  const Range& range = scene.visualisationRange;
  return (voxel - range.minimum) / (range.maximum - range.minimum);
}

class Culling : public testing::TestWithParam<Case> {};

TEST_P(Culling, ChangesNoPixelOnAnyFrame) {
  REQUIRE_MESH_SHADERS();
  const Case& c = GetParam();
  Numbers numbers(29);
  constexpr int kSteps = 3;
  const Scene scene = parts::makeScene(randomSteps(numbers, c.dims, c.type, kSteps, c.plateaus), ShadingModel::gooch);
  const Grid& grid = scene.volume->grid();
  Session all = makeSession(scene, c.values, false, c.views);
  Session culled = makeSession(scene, c.values, true, c.views);
  FrameInputs inputs = parts::makeInputs(parts::lookAtBox(grid, 10, 20, kWidth, kHeight), 0.4);
  double azimuth = 10;
  std::uint64_t saved = 0;
  for (int frame = 0; frame < 60; ++frame) {
    // Mostly a camera that goes on; now and then everything else jumps.
    azimuth += 4;
    inputs.views = {parts::lookAtBox(grid, azimuth, 20, kWidth, kHeight)};
    if (frame % 7 == 3) inputs.views = {parts::randomView(numbers, grid, kWidth, kHeight)};
    if (frame % 5 == 2) inputs.isovalue = numbers.between(0.02, 0.98);
    if (c.plateaus) inputs.isovalue = isovalueOf(scene, kPlateau * numbers.integer(1, 7));
    if (frame % 11 == 6) inputs.timeStep = numbers.integer(0, kSteps - 1);
    if (frame % 13 == 8) inputs.clippingPlanes = parts::randomPlanes(numbers, grid);
    if (frame == 40) inputs.isovalue = 1.5;
    if (frame == 50) {
      all.reset();
      culled.reset();
    }
    if (c.views == 2) {
      View right = inputs.views[0];
      right.pose.position += 0.05 * grid.boundingRadiusMm() * right.pose.right;
      right.layer = 1;
      inputs.views.push_back(right);
    }
    const bool counting = frame % 2 == 1;
    const Drawn expected = all.draw(inputs, counting);
    const Drawn found = culled.draw(inputs, counting);
    for (std::size_t view = 0; view < expected.pictures.size(); ++view)
      ASSERT_TRUE(parts::identical(found.pictures[view], expected.pictures[view]))
          << fmt::format("frame {}, view {}: {}", frame, view,
                         parts::largestDifference(found.pictures[view], expected.pictures[view]));
    if (!counting) continue;
    ASSERT_TRUE(found.pictures[0].normal == expected.pictures[0].normal) << frame;
    ASSERT_LE(found.counters.at("blocks"), expected.counters.at("blocks")) << frame;
    ASSERT_LE(found.counters.at("triangles"), expected.counters.at("triangles")) << frame;
    saved += expected.counters.at("blocks") - found.counters.at("blocks");
  }
  if (c.hides) {
    EXPECT_GT(saved, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Culling, testing::ValuesIn(cases()), [](const auto& one) { return one.param.name; });

TEST(VisibleSets, RegionsThatHoldTheEyeAreDrawn) {
  REQUIRE_MESH_SHADERS();
  // No proxy can show them: it would have to be nearer than the near plane.
  Numbers numbers(41);
  const Scene scene =
      parts::makeScene(parts::makeVolume(parts::ball, glm::ivec3(64), ScalarType::uint16), ShadingModel::gooch);
  const double level = 0.4;
  const Range range = scene.volume->dataRange();
  const double radius = 32 * (1 - (range.minimum + level * (range.maximum - range.minimum)) / 65535);
  Session all = makeSession(scene, {}, false, 1);
  Session culled = makeSession(scene, {}, true, 1);
  int near = 0;
  for (int frame = 0; frame < 40; ++frame) {
    const glm::dvec3 out = glm::normalize(glm::dvec3(numbers.unit(), numbers.unit(), numbers.unit()) - 0.5);
    const glm::dvec3 eye = (radius + numbers.between(0.5, 4)) * out;
    const glm::dvec3 side = 4.0 * glm::dvec3(numbers.unit() - 0.5, numbers.unit() - 0.5, numbers.unit() - 0.5);
    FrameInputs inputs = parts::makeInputs(
        {.pose = Pose::lookAt(eye, radius * out + side), .frustum = Frustum::symmetric(60, kWidth, kHeight)}, level);
    const Drawn expected = all.draw(inputs);
    ASSERT_TRUE(parts::identical(culled.draw(inputs).pictures[0], expected.pictures[0])) << frame;
    near += std::any_of(expected.pictures[0].distance.begin(), expected.pictures[0].distance.end(),
                        [](float d) { return d < 4; });
  }
  EXPECT_GT(near, 30);
}

/// A sheet across the box, all of which is seen from the front.
Scene sheet() {
  return parts::makeScene(parts::makeVolume(
                              [](const glm::dvec3& p) {
                                return std::clamp(0.5 - 4 * (p.z - 0.5 - 0.1 * std::sin(6 * p.x + 4 * p.y)), 0.0, 1.0);
                              },
                              glm::ivec3(49), ScalarType::uint16),
                          ShadingModel::none);
}

TEST(VisibleSets, EachBlockIsDrawnOnceInAFrame) {
  REQUIRE_MESH_SHADERS();
  const Scene scene = sheet();
  const parts::SurfaceCounts expected = parts::countSurface(scene, 0.5, {8, 8, 4}, 96);
  Session session = makeSession(scene, {}, true, 1);
  const FrameInputs inputs = parts::makeInputs(parts::lookAtBox(scene.volume->grid(), 5, 10, kWidth, kHeight));
  // The first frame draws all in its last pass, later ones in their first pass.
  for (int frame = 0; frame < 3; ++frame) {
    const Drawn drawn = session.draw(inputs, true);
    EXPECT_EQ(drawn.counters.at("blocks"), expected.blocks) << frame;
    EXPECT_EQ(drawn.counters.at("triangles"), expected.triangles) << frame;
  }
}

TEST(VisibleSets, WhatASheetHidesIsNotDrawn) {
  REQUIRE_MESH_SHADERS();
  // Two sheets, one behind the other.
  const Scene scene =
      parts::makeScene(parts::makeVolume(
                           [](const glm::dvec3& p) {
                             const double wave = 0.05 * std::sin(6 * p.x + 4 * p.y);
                             return std::max(std::clamp(1 - 10 * std::abs(p.z - 0.75 - wave), 0.0, 1.0),
                                             std::clamp(1 - 10 * std::abs(p.z - 0.25 - wave), 0.0, 1.0));
                           },
                           glm::ivec3(65), ScalarType::uint16),
                       ShadingModel::none);
  Session session = makeSession(scene, {{"granularity", std::string("block")}}, true, 1);
  View view = parts::lookAtBox(scene.volume->grid(), 0, 0, kWidth, kHeight);
  view.frustum = Frustum::symmetric(12, kWidth, kHeight); // nothing but the sheets
  const parts::SurfaceCounts all = parts::countSurface(scene, 0.5, {8, 8, 4}, 96);
  for (int frame = 0; frame < 3; ++frame) {
    const Drawn drawn = session.draw(parts::makeInputs(view), true);
    // Nothing hides anything in the first frame; the second one draws again what the first one saw.
    if (frame < 2) continue;
    EXPECT_LT(drawn.counters.at("blocks"), all.blocks / 3);
    EXPECT_GT(drawn.counters.at("blocks"), 0u);
  }
}

TEST(VisibleSets, BlocksBehindTheEyeAreNotDrawn) {
  REQUIRE_MESH_SHADERS();
  const Scene scene = sheet();
  Session session = makeSession(scene, {}, true, 1);
  View view = parts::lookAtBox(scene.volume->grid(), 0, 0, kWidth, kHeight);
  view.pose = Pose::lookAt({0, 0, 100}, {0, 0, 200});
  const Drawn drawn = session.draw(parts::makeInputs(view), true);
  EXPECT_EQ(drawn.counters.at("blocks"), 0u);
  EXPECT_GT(drawn.counters.at("occupied_regions"), 0u);
}

} // namespace
} // namespace volmark::direct_rasterization
