// Skipping changes no pixel: every method against dvr_raymarch, which skips nothing.
#include "parts/testing/random_scenes.h"
#include "ray_march/dvr_raymarch.h"
#include "skipping_technique.h"
#include "volmark/gpu/shader.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

// Written by volmark_embed_shaders() in CMakeLists.txt.
namespace volmark_ray_march_embedded {
extern const std::vector<volmark::gpu::EmbeddedShader> shaders;
}

namespace volmark::empty_space_skipping {
namespace {

using Values = std::vector<std::pair<std::string, ParameterValue>>;
using parts::Drawn;
using parts::Session;

constexpr int kWidth = 28;
constexpr int kHeight = 24;

struct Method {
  std::string name;
  TechniqueFactory (*factory)();
  Values values{};
  bool tooLargeToSkip = false;
};

void PrintTo(const Method& method, std::ostream* out) {
  *out << method.name;
}

/// Every structure, each with parameters that differ in kind; all leaf sizes, widths, levels and traversals are among
/// them.
std::vector<Method> methods() {
  const auto octree = [](std::int64_t leaf, std::int64_t level, const char* traversal) {
    return Values{{"leaf", leaf}, {"initial_level", level}, {"traversal", std::string(traversal)}};
  };
  const auto bitfield = [&](std::int64_t leaf, std::int64_t bits, std::int64_t level, const char* traversal) {
    Values values = octree(leaf, level, traversal);
    values.emplace_back("bits", bits);
    return Method{fmt::format("bitfield_leaf{}_bits{}_{}", leaf, bits, traversal), dvrBitfieldOctree, values,
                  leaf > 16};
  };
  return {bitfield(2, 8, 0, "bidirectional"),
          bitfield(4, 16, 0, "top_down"),
          bitfield(4, 32, -1, "bidirectional"),
          bitfield(8, 64, 0, "bidirectional"),
          bitfield(16, 128, 0, "bidirectional"),
          bitfield(32, 32, 0, "top_down"),
          bitfield(64, 128, 0, "bidirectional"),
          {"minmax_leaf2", dvrMinMaxOctree, octree(2, 0, "bidirectional")},
          {"minmax_leaf8", dvrMinMaxOctree, octree(8, -1, "top_down")},
          {"boolean_leaf4", dvrBooleanOctree, octree(4, 0, "bidirectional")},
          {"boolean_leaf16", dvrBooleanOctree, octree(16, 0, "top_down")},
          {"distance_texel4", dvrDistanceMap},
          {"distance_texel2", dvrDistanceMap, {{"texel", std::int64_t(2)}}},
          {"distance_texel16", dvrDistanceMap, {{"texel", std::int64_t(16)}}},
          {"chebyshev_texel4", dvrChebyshevDistance},
          {"chebyshev_texel2", dvrChebyshevDistance, {{"texel", std::int64_t(2)}}},
          {"bricks8", dvrRayQuery},
          {"bricks2", dvrRayQuery, {{"brick", std::int64_t(2)}}}};
}

TechniqueFactory plainMarching() {
  static const bool registered = (gpu::registerShaders(volmark_ray_march_embedded::shaders), true);
  static_cast<void>(registered);
  return ray_march::dvrRaymarch();
}

/// A volume and what both techniques are told alike.
struct Case {
  glm::ivec3 dims;
  ScalarType type;
  glm::dvec3 spacing;
  Values march;
  bool lit = false;    ///< by a spotlight, with shadows
  bool beyond = false; ///< draws what clipping planes cut off
  bool segmented = false;
};

const Case kCases[] = {
    {{33, 29, 31}, ScalarType::uint8, {1, 1, 1}, {{"step", 0.5}}, false, false, true},
    {{65, 17, 3}, ScalarType::float32, {1, 1, 1}, {{"step", 0.7}, {"early_termination", false}}, true},
    {{17, 17, 17},
     ScalarType::uint16,
     {0.7, 1.3, 2.1},
     {{"step", 1.0}, {"filtering", std::string("shader")}},
     true,
     false,
     true},
    {{40, 2, 23}, ScalarType::int16, {1, 1, 1}, {{"step", 0.31}}, true, true},
    {{31, 33, 30},
     ScalarType::uint8,
     {1, 1, 1.5},
     {{"step", 1.0}, {"transfer_function_kind", std::string("preintegrated")}},
     false,
     true,
     true},
    {{24, 35, 19},
     ScalarType::float32,
     {1.2, 1, 0.9},
     {{"step", 3.5}, {"transfer_function_kind", std::string("preintegrated")}, {"early_termination", false}},
     true,
     true,
     true},
    {{29, 31, 27}, ScalarType::int8, {1, 1, 1}, {{"step", 0.8}, {"jitter", true}}, false, true},
    {{1, 19, 20}, ScalarType::uint8, {1, 1, 1}, {{"step", 0.5}}},
};

/// Each method is tested with a few cases, and each case with several methods. VOLMARK_ALL_CASES=1 tests all pairs,
/// which takes some minutes: most of it goes into compiling pipelines.
std::vector<Case> casesOf(const Method& method) {
  if (std::getenv("VOLMARK_ALL_CASES")) return {std::begin(kCases), std::end(kCases)};
  const std::vector<Method> all = methods();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Method& m) { return m.name == method.name; });
  const auto index = static_cast<std::size_t>(found - all.begin());
  return {kCases[index % std::size(kCases)], kCases[(3 * index + 5) % std::size(kCases)]};
}

Light randomLight(parts::Numbers& numbers, bool spot) {
  const glm::dvec3 direction(numbers.between(-1, 1), numbers.between(-1, 1), numbers.between(0.1, 1));
  return {
      .headlight = !spot, .direction = glm::normalize(direction), .spot = spot, .distance = numbers.between(1.2, 5)};
}

class Skipping : public testing::TestWithParam<Method> {};

TEST_P(Skipping, ChangesNoPixel) {
  const Method& method = GetParam();
  if (method.factory == dvrRayQuery && !parts::device().facts().rayQuery) GTEST_SKIP() << "no ray queries";
  constexpr int kFunctions = 16; // of each case
  parts::Numbers numbers(7);
  int skippedSomething = 0;
  for (const Case& c : casesOf(method)) {
    Scene scene = parts::makeScene(parts::randomVolume(numbers, c.dims, c.type, c.spacing),
                                   c.lit ? ShadingModel::ggx : ShadingModel::none);
    scene.shading.shadows = c.lit;
    if (c.segmented)
      scene.volume =
          std::make_shared<const Volume>(scene.volume->withLabels(parts::randomLabels(numbers, c.dims, c.spacing)));
    if (c.beyond) scene.functionBeyond = parts::randomTransferFunction(numbers);
    Values march = c.march;
    march.emplace_back("shadow_resolution", std::int64_t(48));
    march.emplace_back("preintegrated_size", std::int64_t(64));
    Values values = march;
    values.insert(values.end(), method.values.begin(), method.values.end());
    const TechniqueFactory factory = method.factory();
    const ParameterValues parameters = parts::withParameters(factory, values);
    const OutputSize size{kWidth, kHeight, 1};
    ASSERT_EQ(factory.whyUnsupported(scene, parameters, size, &parts::device()), std::nullopt);
    Session plain(plainMarching(), scene, parts::withParameters(plainMarching(), march), size);
    Session skipping(factory, scene, parameters, size);
    for (int i = 0; i < kFunctions; ++i) {
      const Grid& grid = scene.volume->grid();
      const FrameInputs inputs{.views = {parts::randomView(numbers, grid, kWidth, kHeight)},
                               .transferFunction = parts::randomTransferFunction(numbers),
                               .clippingPlanes = parts::randomPlanes(numbers, grid),
                               .light = randomLight(numbers, c.lit),
                               .hiddenSegments =
                                   c.segmented ? parts::randomSegments(numbers) : std::bitset<kMaximumSegments>()};
      const Drawn expected = plain.draw(inputs, true);
      const Drawn found = skipping.draw(inputs, true);
      const std::string where = fmt::format("{} x {} x {}, function {}", c.dims.x, c.dims.y, c.dims.z, i);
      EXPECT_LE(parts::largestDifference(found.pictures[0], expected.pictures[0]), 1.0 / 255) << where;
      EXPECT_LE(parts::meanDifference(found.pictures[0], expected.pictures[0]), 1e-4) << where;
      EXPECT_EQ(found.counters.at("visible_samples"), expected.counters.at("visible_samples")) << where;
      EXPECT_EQ(found.counters.at("rays"), expected.counters.at("rays")) << where;
      if (found.counters.at("samples") < expected.counters.at("samples")) ++skippedSomething;
    }
  }
  // Leaves as large as the volume hold something visible.
  if (!method.tooLargeToSkip) {
    EXPECT_GT(skippedSomething, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Skipping, testing::ValuesIn(methods()), [](const auto& one) { return one.param.name; });

TEST(BitfieldOctree, SlabsThatStepOverABlockAreDrawn) {
  // From 0 to 1 within a cell, and only what lies between is visible: samples on both sides are in empty blocks.
  const Scene scene =
      parts::makeScene(parts::makeVolume([](const glm::dvec3& p) { return p.x + 0.3 * p.z < 0.6 ? 0.0 : 1.0; },
                                         {33, 33, 33}, ScalarType::uint8),
                       ShadingModel::none);
  const Values march = {{"step", 4.0},
                        {"transfer_function_kind", std::string("preintegrated")},
                        {"preintegrated_size", std::int64_t(64)}};
  Values values = march;
  values.emplace_back("leaf", std::int64_t(2));
  const FrameInputs inputs{
      .views = {parts::lookAtBox(scene.volume->grid(), 70, 10, kWidth, kHeight)},
      .transferFunction = std::make_shared<TransferFunction>(
          "middle", std::vector<ControlPoint>{{0.4, {1, 1, 1}, 0}, {0.5, {1, 1, 1}, 0.5}, {0.6, {1, 1, 1}, 0}})};
  const Drawn expected = parts::drawOnce(plainMarching(), scene, inputs, kWidth, kHeight, march, true);
  const Drawn found = parts::drawOnce(dvrBitfieldOctree(), scene, inputs, kWidth, kHeight, values, true);
  EXPECT_GT(expected.counters.at("visible_samples"), 100u);
  EXPECT_EQ(found.counters.at("visible_samples"), expected.counters.at("visible_samples"));
  EXPECT_LE(parts::largestDifference(found.pictures[0], expected.pictures[0]), 1.0 / 255);
}

TEST(BitfieldOctree, MoreBitsNeverSkipLess) {
  parts::Numbers numbers(3);
  const Scene scene =
      parts::makeScene(parts::randomVolume(numbers, {48, 40, 44}, ScalarType::uint16, {1, 1, 1}), ShadingModel::none);
  std::vector<std::unique_ptr<Session>> byBits;
  for (const std::int64_t bits : {8, 16, 32, 64, 128})
    byBits.push_back(std::make_unique<Session>(
        dvrBitfieldOctree(), scene,
        parts::withParameters(dvrBitfieldOctree(), {{"bits", bits}, {"early_termination", false}, {"step", 0.5}}),
        OutputSize{kWidth, kHeight, 1}));
  bool differs = false;
  for (int i = 0; i < 40; ++i) {
    const FrameInputs inputs{.views = {parts::randomView(numbers, scene.volume->grid(), kWidth, kHeight)},
                             .transferFunction = parts::randomTransferFunction(numbers)};
    std::vector<std::uint64_t> samples;
    for (const auto& session : byBits)
      samples.push_back(session->draw(inputs, true).counters.at("samples"));
    EXPECT_TRUE(std::is_sorted(samples.rbegin(), samples.rend())) << testing::PrintToString(samples);
    differs = differs || samples.front() != samples.back();
  }
  EXPECT_TRUE(differs);
}

TEST(BitfieldOctree, TwoEyesEqualTwoPictures) {
  parts::Numbers numbers(11);
  const Scene scene =
      parts::makeScene(parts::randomVolume(numbers, {31, 32, 33}, ScalarType::uint8, {1, 1, 1}), ShadingModel::ggx);
  const Grid& grid = scene.volume->grid();
  FrameInputs inputs{
      .views = {parts::lookAtBox(grid, 20, 10, kWidth, kHeight), parts::lookAtBox(grid, 25, 10, kWidth, kHeight)},
      .transferFunction = parts::randomTransferFunction(numbers)};
  inputs.views[1].layer = 1;
  const Drawn both = parts::drawOnce(dvrBitfieldOctree(), scene, inputs, kWidth, kHeight, {});
  for (std::size_t eye = 0; eye < 2; ++eye) {
    FrameInputs one = inputs;
    one.views = {inputs.views[eye]};
    one.views[0].layer = 0;
    EXPECT_TRUE(parts::identical(parts::drawOnce(dvrBitfieldOctree(), scene, one, kWidth, kHeight, {}).pictures[0],
                                 both.pictures[eye]));
  }
}

TEST(BitfieldOctree, StepsArePixelsOfItsCounters) {
  parts::Numbers numbers(5);
  const Scene scene =
      parts::makeScene(parts::randomVolume(numbers, {31, 32, 33}, ScalarType::uint8, {1, 1, 1}), ShadingModel::none);
  const FrameInputs inputs{.views = {parts::lookAtBox(scene.volume->grid(), 20, 10, kWidth, kHeight)},
                           .transferFunction = parts::randomTransferFunction(numbers)};
  const Drawn drawn = parts::drawOnce(dvrBitfieldOctree(), scene, inputs, kWidth, kHeight, {}, true);
  double steps = 0;
  for (const float of : drawn.pictures[0].steps)
    steps += of;
  EXPECT_EQ(steps, double(drawn.counters.at("samples") + drawn.counters.at("node_tests")));
}

TEST(BitfieldOctree, MemoryIsWhatItAddedToTheLedger) {
  parts::Numbers numbers(5);
  const Scene scene =
      parts::makeScene(parts::randomVolume(numbers, {31, 32, 33}, ScalarType::uint8, {1, 1, 1}), ShadingModel::none);
  for (const Method& method : methods()) {
    const TechniqueFactory factory = method.factory();
    const Session session(factory, scene, parts::withParameters(factory, method.values), {kWidth, kHeight, 1});
    std::uint64_t bytes = 0;
    for (const gpu::MemoryItem& item : session.technique().memory())
      bytes += item.bytes;
    EXPECT_EQ(bytes, session.preparedBytes()) << method.name;
  }
}

std::string refusal(TechniqueFactory factory, const Scene& scene, const Values& values) {
  return factory.whyUnsupported(scene, parts::withParameters(factory, values), {kWidth, kHeight, 1}, &parts::device())
      .value_or("");
}

TEST(BitfieldOctree, RefusesWhatCannotBe) {
  const Scene scene =
      parts::makeScene(parts::makeVolume(parts::ball, {33, 33, 33}, ScalarType::uint8), ShadingModel::none);
  EXPECT_EQ(refusal(dvrBitfieldOctree(), scene, {{"leaf", std::int64_t(4)}, {"initial_level", std::int64_t(3)}}), "");
  EXPECT_EQ(refusal(dvrBitfieldOctree(), scene, {{"leaf", std::int64_t(4)}, {"initial_level", std::int64_t(4)}}),
            "initial_level: found 4, allowed: at most 3, the level of the leaves of this octree (leaf 4).");
  EXPECT_THROW(parts::withParameters(dvrBitfieldOctree(), {{"leaf", std::int64_t(3)}}), std::exception);
  EXPECT_THROW(parts::withParameters(dvrBitfieldOctree(), {{"bits", std::int64_t(12)}}), std::exception);
}

} // namespace
} // namespace volmark::empty_space_skipping
