// Skipping changes no bit: every setting of the octree against iso_raymarch, which skips nothing.
#include "iso_octree.h"
#include "parts/testing/random_scenes.h"
#include "ray_march/iso_raymarch.h"
#include "volmark/gpu/shader.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

// Written by volmark_embed_shaders() in CMakeLists.txt.
namespace volmark_ray_march_embedded {
extern const std::vector<volmark::gpu::EmbeddedShader> shaders;
}

namespace volmark::octree_isosurface {
namespace {

using Values = std::vector<std::pair<std::string, ParameterValue>>;
using parts::Drawn;
using parts::Numbers;
using parts::Session;

constexpr int kWidth = 60;
constexpr int kHeight = 52;

TechniqueFactory plainMarching() {
  static const bool registered = (gpu::registerShaders(volmark_ray_march_embedded::shaders), true);
  static_cast<void>(registered);
  return ray_march::isoRaymarch();
}

/// A volume, what both techniques are told alike, and what the octree is told.
struct Case {
  std::string name;
  glm::ivec3 dims;
  ScalarType type;
  glm::dvec3 spacing;
  Values march;
  Values octree;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

Values octree(std::int64_t leaf, std::int64_t level, const char* traversal, const char* stage) {
  return {
      {"leaf", leaf}, {"initial_level", level}, {"traversal", std::string(traversal)}, {"stage", std::string(stage)}};
}

std::vector<Case> cases() {
  return {{"uint8_leaf8", {65, 49, 57}, ScalarType::uint8, {1, 1, 1}, {}, octree(8, -1, "bidirectional", "compute")},
          {"uint16_leaf2",
           {33, 40, 37},
           ScalarType::uint16,
           {0.7, 1.3, 2.1},
           {{"step", 0.31}, {"filtering", std::string("shader")}},
           octree(2, 0, "bidirectional", "compute")},
          {"float32_leaf4_fragment",
           {63, 64, 66},
           ScalarType::float32,
           {1, 1, 1},
           {{"bisections", std::int64_t(3)}},
           octree(4, 0, "top_down", "fragment")},
          {"int16_leaf16",
           {40, 2, 53},
           ScalarType::int16,
           {1, 1.5, 1},
           {{"step", 2.5}},
           octree(16, 0, "top_down", "compute")},
          {"int8_leaf32_jitter",
           {70, 35, 41},
           ScalarType::int8,
           {1, 1, 1},
           {{"jitter", true}, {"step", 0.8}},
           octree(32, 0, "bidirectional", "fragment")},
          {"float32_flat",
           {1, 39, 50},
           ScalarType::float32,
           {1, 1, 1},
           {{"step", 0.5}},
           octree(8, -1, "bidirectional", "compute")},
          {"uint8_smallest",
           {2, 2, 2},
           ScalarType::uint8,
           {1, 1, 1},
           {{"step", 0.05}},
           octree(64, 0, "top_down", "compute")}};
}

class Skipping : public testing::TestWithParam<Case> {};

TEST_P(Skipping, ChangesNoBit) {
  const Case& c = GetParam();
  Numbers numbers(11);
  bool skippedSomething = false;
  int hits = 0;
  for (int i = 0; i < 3; ++i) {
    const Scene scene = parts::makeScene(parts::randomVolume(numbers, c.dims, c.type, c.spacing), ShadingModel::gooch);
    const OutputSize size{kWidth, kHeight, 1};
    Values values = c.march;
    values.insert(values.end(), c.octree.begin(), c.octree.end());
    Values plainValues = c.march;
    if (std::none_of(plainValues.begin(), plainValues.end(), [](const auto& v) { return v.first == "bisections"; }))
      plainValues.emplace_back("bisections", std::int64_t(3));
    const ParameterValues parameters = parts::withParameters(isoOctree(), values);
    ASSERT_EQ(isoOctree().whyUnsupported(scene, parameters, size, &parts::device()), std::nullopt);
    Session plain(plainMarching(), scene, parts::withParameters(plainMarching(), plainValues), size);
    Session skipping(isoOctree(), scene, parameters, size);
    for (int k = 0; k < 8; ++k) {
      FrameInputs inputs = parts::makeInputs(parts::randomView(numbers, scene.volume->grid(), kWidth, kHeight),
                                             k < 6 ? numbers.between(0.02, 0.98) : double(k - 6));
      inputs.clippingPlanes = parts::randomPlanes(numbers, scene.volume->grid());
      const Drawn expected = plain.draw(inputs, true);
      const Drawn found = skipping.draw(inputs, true);
      const std::string where = fmt::format("volume {}, frame {}", i, k);
      EXPECT_TRUE(parts::identical(found.pictures[0], expected.pictures[0])) << where;
      EXPECT_TRUE(found.pictures[0].normal == expected.pictures[0].normal) << where;
      EXPECT_EQ(found.counters.at("hits"), expected.counters.at("hits")) << where;
      EXPECT_EQ(found.counters.at("rays"), expected.counters.at("rays")) << where;
      EXPECT_EQ(found.counters.at("gradients"), expected.counters.at("gradients")) << where;
      EXPECT_LE(found.counters.at("samples"), expected.counters.at("samples")) << where;
      skippedSomething |= found.counters.at("samples") < expected.counters.at("samples");
      hits += static_cast<int>(found.counters.at("hits"));
      // The timed pipeline draws what the counting one does.
      EXPECT_TRUE(parts::identical(skipping.draw(inputs).pictures[0], plain.draw(inputs).pictures[0])) << where;
    }
  }
  EXPECT_GT(hits, 1000);
  // Rays through flat volumes take one sample; one leaf holds all of the smallest one.
  EXPECT_TRUE(skippedSomething || c.dims.x <= 2);
}

INSTANTIATE_TEST_SUITE_P(All, Skipping, testing::ValuesIn(cases()), [](const auto& one) { return one.param.name; });

TEST(IsoOctree, SamplesThatAreTheIsovalueAreInside) {
  // A cube of the largest voxel value: no sample exceeds the isovalue, and no node's range does.
  const auto cube = [](const glm::dvec3& p) {
    return glm::all(glm::lessThan(glm::abs(p - 0.5), glm::dvec3(0.3))) ? 1.0 : 0.0;
  };
  for (const ScalarType type : {ScalarType::uint8, ScalarType::float32}) {
    const Scene scene = parts::makeScene(parts::makeVolume(cube, glm::ivec3(40), type), ShadingModel::gooch);
    const FrameInputs inputs = parts::makeInputs(parts::lookAtBox(scene.volume->grid(), 20, 30, kWidth, kHeight), 1.0);
    const Drawn expected =
        parts::drawOnce(plainMarching(), scene, inputs, kWidth, kHeight, {{"bisections", std::int64_t(3)}}, true);
    const Drawn found = parts::drawOnce(isoOctree(), scene, inputs, kWidth, kHeight, {}, true);
    EXPECT_TRUE(parts::identical(found.pictures[0], expected.pictures[0])) << nameOf(type);
    EXPECT_GT(found.counters.at("hits"), 100u);
  }
}

TEST(IsoOctree, BothEyesEqualTwoPictures) {
  for (const char* stage : {"compute", "fragment"}) {
    Numbers numbers(3);
    const Scene scene =
        parts::makeScene(parts::makeVolume(parts::ripples, glm::ivec3(40), ScalarType::uint16), ShadingModel::gooch);
    FrameInputs inputs = parts::makeInputs(parts::lookAtBox(scene.volume->grid(), 33, 21, kWidth, kHeight));
    View right = inputs.views[0];
    right.pose.position += 6.0 * right.pose.right;
    inputs.views.push_back(right);
    // The eyes' layers need not be in the views' order.
    inputs.views[0].layer = 1;
    const Values values{{"stage", std::string(stage)}};
    const Drawn both = parts::drawOnce(isoOctree(), scene, inputs, kWidth, kHeight, values);
    for (int view = 0; view < 2; ++view) {
      FrameInputs one = inputs;
      one.views = {inputs.views[static_cast<std::size_t>(view)]};
      one.views[0].layer = 0;
      EXPECT_TRUE(parts::identical(parts::drawOnce(isoOctree(), scene, one, kWidth, kHeight, values).pictures[0],
                                   both.pictures[static_cast<std::size_t>(1 - view)]))
          << stage << view;
    }
  }
}

TEST(IsoOctree, FollowsTimeSteps) {
  // Two steps in one volume against two volumes of a step.
  const Grid grid{{40, 33, 37}, glm::dvec3(1)};
  Numbers numbers(5);
  std::vector<std::byte> all;
  std::vector<std::shared_ptr<const Volume>> steps;
  for (int i = 0; i < 2; ++i) {
    steps.push_back(parts::randomVolume(numbers, grid.dims, ScalarType::uint8, grid.spacingMm));
    all.insert(all.end(), steps.back()->voxels().begin(), steps.back()->voxels().end());
  }
  Scene scene = parts::makeScene(std::make_shared<Volume>("two", grid, ScalarType::uint8, std::move(all), 2),
                                 ShadingModel::gooch);
  Session session(isoOctree(), scene, parts::withParameters(isoOctree(), {}), {kWidth, kHeight, 1});
  FrameInputs inputs = parts::makeInputs(parts::lookAtBox(grid, 20, 30, kWidth, kHeight), 0.45);
  for (const int step : {1, 0, 1, 1}) {
    inputs.timeStep = step;
    Scene single = scene;
    single.volume = steps[static_cast<std::size_t>(step)];
    FrameInputs first = inputs;
    first.timeStep = 0;
    EXPECT_TRUE(parts::identical(session.draw(inputs).pictures[0],
                                 parts::drawOnce(isoOctree(), single, first, kWidth, kHeight, {}).pictures[0]))
        << step;
  }
}

TEST(IsoOctree, MemoryIsWhatItAddedToTheLedger) {
  const Scene scene =
      parts::makeScene(parts::makeVolume(parts::ball, glm::ivec3(33), ScalarType::uint8), ShadingModel::gooch);
  const Session session(isoOctree(), scene, parts::withParameters(isoOctree(), {}), {kWidth, kHeight, 1});
  std::uint64_t bytes = 0;
  for (const gpu::MemoryItem& item : session.technique().memory())
    bytes += item.bytes;
  EXPECT_EQ(bytes, session.preparedBytes());
}

TEST(IsoOctree, RefusesALevelBelowTheLeaves) {
  const Scene scene =
      parts::makeScene(parts::makeVolume(parts::ball, glm::ivec3(33), ScalarType::uint8), ShadingModel::gooch);
  const auto why = [&](std::int64_t level) {
    return isoOctree().whyUnsupported(scene, parts::withParameters(isoOctree(), {{"initial_level", level}}),
                                      {kWidth, kHeight, 1}, &parts::device());
  };
  EXPECT_EQ(why(2), std::nullopt);
  EXPECT_EQ(why(3).value_or(""), "initial_level: found 3, allowed: at most 2, the level of the leaves of this octree.");
}

} // namespace
} // namespace volmark::octree_isosurface
