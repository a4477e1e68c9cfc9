#include "parts/marcher.h"

#include "volmark/gpu/frame_constants.h"
#include "volmark/gpu/target.h"

#include <algorithm>
#include <cassert>

// Written by volmark_embed_shaders() in CMakeLists.txt.
namespace volmark_parts_embedded {
extern const std::vector<volmark::gpu::EmbeddedShader> shaders;
}

namespace volmark::parts {

namespace {

gpu::Filtering filteringOf(const ParameterValues& parameters) {
  return parameters.text("filtering") == "shader" ? gpu::Filtering::shader : gpu::Filtering::hardware;
}

gpu::PipelineLayoutDescription layoutOf(const std::vector<VkDescriptorType>& own) {
  std::vector<VkDescriptorType> bindings = {
      VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
      VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,  VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,         VK_DESCRIPTOR_TYPE_STORAGE_IMAGE};
  bindings.insert(bindings.end(), own.begin(), own.end());
  return {.bindings = std::move(bindings), .pushConstantBytes = sizeof(MarchConstants)};
}

std::uint32_t layersOf(const std::vector<View>& views) {
  std::uint32_t layers = 0;
  for (std::size_t i = 0; i < views.size(); ++i)
    layers |= static_cast<std::uint32_t>(views[i].layer) << (8 * i);
  return layers;
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
  commands.dispatch(frame.counting ? pipelines.counting : pipelines.timed, resources, gpu::bytesOf(constants), groups);
  if (frame.counting) commands.barrier(gpu::kComputeWrite, gpu::kHostRead);
}

ParameterDescriptor stepParameter(double value) {
  return ParameterDescriptor::number("step", value, 0.01, 4, "voxel", "Distance of samples along a ray.");
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
