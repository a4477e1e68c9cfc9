#include "volmark/gpu/stamp_self_test.h"

#include "volmark/gpu/frame_recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace volmark::gpu {

namespace {

constexpr std::uint32_t kSide = 64; // pixels, and invocations of a dispatch are kSide^2
constexpr std::array<const char*, 3> kDispatches = {"dispatch 1", "dispatch 2", "dispatch 4"};
constexpr std::array<const char*, 3> kDraws = {"draw 1", "draw 2", "draw 4"};
constexpr int kFewestFrames = 5;
constexpr int kMostFrames = 30; // under load it takes some to see undisturbed ones
// Other processes only ever lengthen a pass, and on a busy machine the long ones more; a stamp in the wrong place
// moves a whole pass's time: a factor of 3 and more between times per unit of work.
constexpr double kLargestSpread = 2;
constexpr double kShortestPassMs = 1; // so that launching it does not count
constexpr std::uint32_t kMaximumRounds = 1u << 22;

ImageDescription pictureDescription() {
  ImageDescription description;
  description.format = VK_FORMAT_R32_SFLOAT;
  description.extent = {kSide, kSide, 1};
  description.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
  return description;
}

GraphicsPipelineDescription drawDescription() {
  GraphicsPipelineDescription description;
  description.name = "stamp self-test draw";
  description.shaders = {{"volmark/stamp_work.vert.glsl", VK_SHADER_STAGE_VERTEX_BIT},
                         {"volmark/stamp_work.frag.glsl", VK_SHADER_STAGE_FRAGMENT_BIT}};
  description.layout.pushConstantBytes = sizeof(std::uint32_t);
  description.colorFormats = {VK_FORMAT_R32_SFLOAT};
  return description;
}

class Test {
public:
  explicit Test(Device& device)
      : m_results(device, {"", kSide * kSide * sizeof(std::uint32_t), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT}),
        m_picture(device, pictureDescription()),
        m_dispatch(device, ComputePipelineDescription{"stamp self-test dispatch",
                                                      {"volmark/stamp_work.comp.glsl"},
                                                      {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER}, sizeof(std::uint32_t)}}),
        m_draw(device, drawDescription()), m_commands(device), m_recorder(m_commands, StampMode::breakdown) {}

  /// One frame of all six passes, first pass `rounds` long.
  FrameTimes frame(std::uint32_t rounds) {
    m_recorder.beginFrame();
    m_commands.transition(m_picture, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, kAnything,
                          kAnything);
    for (std::size_t i = 0; i < 3; ++i)
      dispatch(kDispatches[i], rounds << i);
    for (std::size_t i = 0; i < 3; ++i)
      draw(kDraws[i], rounds << i);
    m_recorder.endFrame();
    return m_recorder.finish();
  }

private:
  void dispatch(const char* name, std::uint32_t rounds) {
    const Pass pass = m_recorder.pass(name);
    const Resource resources[] = {m_results.range()};
    m_commands.dispatch(m_dispatch, resources, bytesOf(rounds), {kSide * kSide / 64, 1, 1});
    m_commands.barrier(kComputeWrite, kComputeWrite);
  }

  void draw(const char* name, std::uint32_t rounds) {
    const Pass pass = m_recorder.pass(name);
    VkRenderingAttachmentInfo attachment{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    attachment.imageView = m_picture.layerView(0);
    attachment.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    attachment.loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
    info.renderArea.extent = {kSide, kSide};
    info.layerCount = 1;
    info.colorAttachmentCount = 1;
    info.pColorAttachments = &attachment;
    vkCmdBeginRendering(m_commands.handle(), &info);
    const VkViewport viewport{0, 0, kSide, kSide, 0, 1};
    vkCmdSetViewport(m_commands.handle(), 0, 1, &viewport);
    vkCmdSetScissor(m_commands.handle(), 0, 1, &info.renderArea);
    m_commands.bind(m_draw, {}, bytesOf(rounds));
    vkCmdDraw(m_commands.handle(), 3, 1, 0, 0);
    vkCmdEndRendering(m_commands.handle());
  }

  Buffer m_results;
  Image m_picture;
  Pipeline m_dispatch;
  Pipeline m_draw;
  Commands m_commands;
  FrameRecorder m_recorder;
};

double passMs(const FrameTimes& times, const char* name) {
  for (const RecordedPass& pass : times.passes)
    if (pass.name == name) return pass.ms;
  return 0;
}

/// The shorter one of the two shortest passes, undisturbed by other programs if one of three frames is.
double shortestPassMs(Test& test, std::uint32_t rounds) {
  double shortest = std::numeric_limits<double>::max();
  for (int i = 0; i < 3; ++i) {
    const FrameTimes times = test.frame(rounds);
    shortest = std::min({shortest, passMs(times, kDispatches[0]), passMs(times, kDraws[0])});
  }
  return shortest;
}

/// Doubles the work until the shortest passes are long enough. Also compiles the pipelines.
std::uint32_t calibrate(Test& test) {
  std::uint32_t rounds = 256;
  while (rounds < kMaximumRounds && shortestPassMs(test, rounds) < kShortestPassMs)
    rounds *= 2;
  return rounds;
}

bool areRight(const std::array<double, 3>& ratios) {
  const auto [least, most] = std::minmax({1.0, ratios[1] / 2, ratios[2] / 4});
  return least > 0 && most / least <= kLargestSpread;
}

void keepShortest(double& kept, double ms) {
  if (kept == 0 || ms < kept) kept = ms;
}

void add(const FrameTimes& times, StampSelfTest& result) {
  for (std::size_t i = 0; i < 3; ++i) {
    keepShortest(result.computeMs[i], passMs(times, kDispatches[i]));
    keepShortest(result.drawMs[i], passMs(times, kDraws[i]));
    result.computeRatios[i] = result.computeMs[i] / result.computeMs[0];
    result.drawRatios[i] = result.drawMs[i] / result.drawMs[0];
  }
  result.trusted = areRight(result.computeRatios) && areRight(result.drawRatios);
}

} // namespace

StampSelfTest runStampSelfTest(Device& device) {
  StampSelfTest result;
  if (device.facts().timestampValidBits == 0) return result;
  Test test(device);
  const std::uint32_t rounds = calibrate(test);
  // Other programs only ever lengthen a pass: the shortest time of each is the nearest to the truth.
  for (int i = 0; i < kFewestFrames || (i < kMostFrames && !result.trusted); ++i)
    add(test.frame(rounds), result);
  return result;
}

std::string describe(const StampSelfTest& test) {
  if (test.computeMs[0] <= 0) return "not trusted: the device has no timestamps";
  return fmt::format("{}: dispatches 1 : {:.2f} : {:.2f}, draws 1 : {:.2f} : {:.2f}, expected 1 : 2 : 4",
                     test.trusted ? "trusted" : "not trusted", test.computeRatios[1], test.computeRatios[2],
                     test.drawRatios[1], test.drawRatios[2]);
}

} // namespace volmark::gpu
