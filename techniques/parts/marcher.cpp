#include "parts/marcher.h"

#include "volmark/gpu/frame_constants.h"
#include "volmark/gpu/rendering.h"
#include "volmark/gpu/target.h"

#include <algorithm>
#include <cassert>

// Written by volmark_embed_shaders() in CMakeLists.txt.
namespace volmark_parts_embedded {
extern const std::vector<volmark::gpu::EmbeddedShader> shaders;
}

namespace volmark::parts {

namespace {

gpu::PipelineLayoutDescription layoutOf(const std::vector<VkDescriptorType>& own) {
  std::vector<VkDescriptorType> bindings = {
      VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
      VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,  VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,         VK_DESCRIPTOR_TYPE_STORAGE_IMAGE};
  bindings.insert(bindings.end(), own.begin(), own.end());
  return {.bindings = std::move(bindings), .pushConstantBytes = sizeof(MarchConstants)};
}

/// One triangle over the whole picture of each view.
void drawViews(gpu::Commands& commands, const gpu::Pipeline& pipeline, const Frame& frame,
               std::span<const gpu::Resource> resources, MarchConstants constants) {
  commands.barrier(gpu::kDrawWrite, gpu::kDrawWrite);
  for (std::size_t i = 0; i < frame.inputs.views.size(); ++i) {
    const auto layer = static_cast<std::uint32_t>(frame.inputs.views[i].layer);
    constants.view = static_cast<std::uint32_t>(i);
    const gpu::Rendering rendering(commands,
                                   {.size = {frame.target->width, frame.target->height},
                                    .colors = {{.view = frame.target->color.layerView(layer), .clear = true},
                                               {.view = frame.target->distance.layerView(layer), .clear = true}}});
    commands.bind(pipeline, resources, gpu::bytesOf(constants));
    vkCmdDraw(commands.handle(), 3, 1, 0, 0);
  }
}

} // namespace

void registerPartsShaders() {
  static const bool registered = (gpu::registerShaders(volmark_parts_embedded::shaders), true);
  static_cast<void>(registered);
}

Marcher::Marcher(const Preparation& preparation, Recorder& recorder)
    : m_scene(&preparation.scene), m_stepLength(static_cast<float>(preparation.parameters.number("step") *
                                                                   m_scene->volume->grid().smallestSpacingMm())),
      m_volume(*preparation.device, preparation.scene, filteringOf(preparation.parameters), recorder, 0,
               preparation.scene.volume->timeSteps()),
      m_counters(*preparation.device, kCounterCount) {
  registerPartsShaders();
}

MarchPipelines Marcher::makePipelines(const Preparation& preparation, MarcherDescription description) const {
  return {makePipeline(preparation, description, false), makePipeline(preparation, description, true)};
}

gpu::Pipeline Marcher::makePipeline(const Preparation& preparation, MarcherDescription description,
                                    bool counting) const {
  description.variant.set(kIdShaderFiltering, m_volume.filtering() == gpu::Filtering::shader)
      .set(kIdShadingModel, static_cast<std::uint32_t>(preparation.scene.shading.model))
      .set(kIdJitter, preparation.parameters.boolean("jitter"))
      .set(kIdCounting, counting);
  if (description.isFragment) {
    description.shader.stage = VK_SHADER_STAGE_FRAGMENT_BIT;
    description.shader.macros.emplace_back("FRAGMENT", "1");
    gpu::GraphicsPipelineDescription graphics{.name = description.shader.path + (counting ? " counting" : "")};
    graphics.shaders = {{"parts/full_screen.vert.glsl", VK_SHADER_STAGE_VERTEX_BIT, {}}, description.shader};
    graphics.layout = layoutOf(description.own);
    graphics.specialisation = description.variant;
    graphics.colorFormats = {gpu::kColorFormat, gpu::kDepthFormat};
    return {*preparation.device, graphics};
  }
  return {*preparation.device,
          gpu::ComputePipelineDescription{.name = description.shader.path + (counting ? " counting" : ""),
                                          .shader = description.shader,
                                          .layout = layoutOf(description.own),
                                          .specialisation = description.variant}};
}

void Marcher::beginFrame(const Frame& frame, Recorder& recorder) const {
  if (frame.counting) m_counters.clear(recorder.gpu());
}

void Marcher::march(const MarchPipelines& pipelines, const Frame& frame, std::uint64_t seed,
                    const MarchConstants& constants, std::span<const gpu::Resource> own, Recorder& recorder) const {
  const glm::uvec3 groups((frame.target->width + kGroupSize - 1) / kGroupSize,
                          (frame.target->height + kGroupSize - 1) / kGroupSize, frame.inputs.views.size());
  const Pass pass = recorder.pass("march");
  dispatch(pipelines, frame, seed, constants, own, groups, recorder);
}

void Marcher::marchFromLight(const MarchPipelines& pipelines, const Frame& frame, const MarchConstants& constants,
                             std::span<const gpu::Resource> own, Recorder& recorder) const {
  const auto groups = static_cast<std::uint32_t>((constants.shadowSize + kGroupSize - 1) / kGroupSize);
  const Pass pass = recorder.pass("shadow_map");
  dispatch(pipelines, frame, 0, constants, own, {groups, groups, 1}, recorder);
}

void Marcher::dispatch(const MarchPipelines& pipelines, const Frame& frame, std::uint64_t seed,
                       MarchConstants constants, std::span<const gpu::Resource> own, glm::uvec3 groups,
                       Recorder& recorder) const {
  assert(frame.target && static_cast<int>(frame.inputs.views.size()) <= gpu::kMaxViews);
  constants.stepLength = m_stepLength;
  constants.layers = layersOf(frame.inputs.views);

  gpu::Commands& commands = recorder.gpu();
  std::vector<gpu::Resource> resources = {commands.constants(gpu::frameConstants(frame, *m_scene, m_volume, seed)),
                                          m_volume.at(frame.inputs.timeStep),
                                          gpu::StorageImage{frame.target->color.view()},
                                          gpu::StorageImage{frame.target->distance.view()},
                                          m_counters.range(),
                                          gpu::StorageImage{frame.target->steps.view()}};
  resources.insert(resources.end(), own.begin(), own.end());
  const gpu::Pipeline& pipeline = frame.counting ? pipelines.counting : pipelines.timed;
  if (pipeline.bindPoint() == VK_PIPELINE_BIND_POINT_COMPUTE)
    commands.dispatch(pipeline, resources, gpu::bytesOf(constants), groups);
  else
    drawViews(commands, pipeline, frame, resources, constants);
  if (frame.counting)
    commands.barrier({VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_SHADER_WRITE_BIT}, gpu::kHostRead);
}

std::uint32_t layersOf(const std::vector<View>& views) {
  std::uint32_t layers = 0;
  for (std::size_t i = 0; i < views.size(); ++i)
    layers |= static_cast<std::uint32_t>(views[i].layer) << (8 * i);
  return layers;
}

ParameterDescriptor stepParameter(double value) {
  return ParameterDescriptor::number("step", value, 0.01, 4, "voxel", "Distance of samples along a ray.");
}

gpu::Filtering filteringOf(const ParameterValues& parameters) {
  return parameters.text("filtering") == "shader" ? gpu::Filtering::shader : gpu::Filtering::hardware;
}

ParameterDescriptor filteringParameter() {
  return ParameterDescriptor::choice("filtering", "hardware", {"hardware", "shader"},
                                     "The sampler's linear filter, or eight fetches interpolated in 32-bit floats.");
}

ParameterDescriptor jitterParameter() {
  return ParameterDescriptor::boolean("jitter", false,
                                      "Shift all samples of a ray by a random share of a step, new in each frame.");
}

std::vector<CounterDescriptor> counterDescriptors(const std::string& ended, const std::string& endedDocumentation) {
  return {{"samples", CounterKind::perDevice, "Samples along rays; those of gradients are not counted."},
          {"rays", CounterKind::perDevice, "Rays that meet the unclipped part of the volume's box."},
          {ended, CounterKind::perDevice, endedDocumentation},
          {"gradients", CounterKind::perDevice, "Gradients evaluated (up to six samples each)."}};
}

std::optional<std::string> whyUnsupported(const Scene& scene, const ParameterValues& parameters, const OutputSize& size,
                                          const gpu::Device* device) {
  if (size.views > gpu::kMaxViews)
    return "The point has " + std::to_string(size.views) + " views, allowed are at most " +
           std::to_string(gpu::kMaxViews) + ".";
  return gpu::VolumeTexture::whyUnsupported(*device, *scene.volume, filteringOf(parameters));
}

std::vector<gpu::MemoryItem> memoryAdded(const std::vector<gpu::MemoryItem>& before,
                                         const std::vector<gpu::MemoryItem>& after) {
  std::vector<gpu::MemoryItem> added;
  for (gpu::MemoryItem item : after) {
    const auto old = std::find_if(before.begin(), before.end(),
                                  [&](const gpu::MemoryItem& other) { return other.name == item.name; });
    if (old != before.end()) item.bytes -= old->bytes;
    if (item.bytes > 0) added.push_back(item);
  }
  return added;
}

} // namespace volmark::parts
