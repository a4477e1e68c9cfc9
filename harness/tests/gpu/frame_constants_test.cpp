#include "gpu_test.h"
#include "volmark/gpu/frame_constants.h"
#include "volmark/gpu/frame_recorder.h"
#include "volmark/gpu/target.h"
#include "volumes.h"

#include <optional>

namespace volmark::gpu::test {

namespace {

using FrameConstantsTest = GpuTest;

/// Writes the members in order, as 32-bit words: invocation i writes the i-th one.
constexpr const char* kDump = R"(
int n = 0;
uint word = 0u;
#define PUT(x) word = i == n++ ? (x) : word
#define PUT3(v) PUT(floatBitsToUint(v.x)); PUT(floatBitsToUint(v.y)); PUT(floatBitsToUint(v.z))
#define PUT4(v) PUT3(v); PUT(floatBitsToUint(v.w))
for (int k = 0; k < kMaxViews; ++k) {
  PUT3(frame.views[k].position); PUT3(frame.views[k].right); PUT3(frame.views[k].up); PUT3(frame.views[k].forward);
  PUT4(frame.views[k].tangents);
}
for (int k = 0; k < kMaxClippingPlanes; ++k) { PUT4(frame.clippingPlanes[k]); }
PUT3(frame.boxMinimum); PUT3(frame.boxMaximum); PUT3(frame.spacing);
PUT(uint(frame.dims.x)); PUT(uint(frame.dims.y)); PUT(uint(frame.dims.z));
PUT(uint(frame.size.x)); PUT(uint(frame.size.y));
PUT(frame.viewCount); PUT(frame.clippingPlaneCount);
PUT(floatBitsToUint(frame.isovalue)); PUT(floatBitsToUint(frame.valueScale)); PUT(floatBitsToUint(frame.valueBias));
PUT(floatBitsToUint(frame.smallestSpacing));
PUT4(frame.light); PUT3(frame.lightColor);
PUT(floatBitsToUint(frame.ambient)); PUT(frame.headlight); PUT(frame.shadingModel);
PUT3(frame.surfaceColor); PUT(frame.frameIndex); PUT(frame.seed);
result[i] = word;
)";

} // namespace

TEST_F(FrameConstantsTest, ShadersReadWhatTheHostWrote) {
  constexpr std::size_t count = sizeof(FrameConstants) / 4;
  std::vector<std::uint32_t> words(count);
  for (std::size_t i = 0; i < count; ++i)
    words[i] = 0x3f800000u + static_cast<std::uint32_t>(i); // 1.00..., no NaN
  const Buffer buffer = bufferOf(words);
  const auto found = evaluate<std::uint32_t>("uint", count, "#include <volmark/frame.glsl>\nVOLMARK_FRAME(1)", kDump,
                                             {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER}, {buffer.range()});
  EXPECT_EQ(found, words);
}

TEST_F(FrameConstantsTest, AreFilledFromSceneAndInputs) {
  Scene scene = sceneOf(randomVolume(ScalarType::int16, {5, 6, 7}, {1, 2, 0.5}));
  scene.visualisationRange = {-1000, 3000};
  scene.shading = {ShadingModel::phong, {0.1, 0.2, 0.3}};
  FrameInputs inputs;
  inputs.views.resize(2);
  inputs.views[1].pose.position = {4, 5, 6};
  inputs.views[1].frustum = {-0.1, 0.2, -0.3, 0.4};
  inputs.isovalue = 0.25;
  inputs.clippingPlanes = {{{0, 1, 0}, 2.5}};
  inputs.light = {.headlight = false, .direction = {0, 3, 4}, .color = glm::dvec3(0.5, 0.6, 0.7), .ambient = 0.2};

  Commands commands(device());
  FrameRecorder recorder(commands);
  recorder.beginFrame();
  const VolumeTexture texture(device(), scene, Filtering::shader, recorder);
  recorder.endFrame();
  recorder.finish();
  Target target(device(), 32, 16, 2);
  const Frame frame{7, inputs, false, &target, nullptr};
  const FrameConstants constants = frameConstants(frame, scene, texture, 0x500000002);
  FrameInputs bySpot = inputs;
  bySpot.light = {.headlight = false, .direction = {0, 0.6, 0.8}, .spot = true, .distance = 2};
  const Frame spotFrame{7, bySpot, false, &target, nullptr};
  const FrameConstants spot = frameConstants(spotFrame, scene, texture, 0);

  EXPECT_EQ(constants.viewCount, 2u);
  EXPECT_EQ(constants.views[1].position, vec3(4, 5, 6));
  EXPECT_EQ(constants.views[1].tangents, vec4(-0.1f, 0.2f, -0.3f, 0.4f));
  EXPECT_EQ(constants.clippingPlaneCount, 1u);
  EXPECT_EQ(constants.clippingPlanes[0], vec4(0, 1, 0, 2.5f));
  EXPECT_EQ(constants.boxMaximum, vec3(2, 5, 1.5f));
  EXPECT_EQ(constants.boxMinimum, vec3(-2, -5, -1.5f));
  EXPECT_EQ(constants.dims, ivec3(5, 6, 7));
  EXPECT_EQ(constants.size, ivec2(32, 16));
  EXPECT_EQ(constants.smallestSpacing, 0.5f);
  EXPECT_EQ(constants.isovalue, 0.25f);
  EXPECT_LT(glm::distance(constants.light, vec4(0, 0.6f, 0.8f, 0)), 1e-6f);
  // Half the diagonal of 4 x 10 x 3.
  EXPECT_LT(glm::distance(spot.light, vec4(vec3(0, 0.6f, 0.8f) * 5.5901699f * 2.0f, 1)), 1e-5f);
  EXPECT_EQ(constants.headlight, 0u);
  EXPECT_EQ(constants.shadingModel, 2u);
  EXPECT_EQ(constants.surfaceColor, vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(constants.frameIndex, 7u);
  EXPECT_EQ(constants.seed, 7u);
  // Raw 600 is stored as 33368 of 65535.
  EXPECT_NEAR(constants.valueScale * (33368.0 / 65535) + constants.valueBias, 0.4, 1e-6);
}

} // namespace volmark::gpu::test
