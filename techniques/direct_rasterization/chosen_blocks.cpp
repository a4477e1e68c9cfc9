#include "chosen_blocks.h"

#include <algorithm>

namespace volmark::direct_rasterization {

namespace {

parts::CompactionDescription describe(const parts::SurfaceRaster& raster, const char* shader, const std::string& name,
                                      Choice choice) {
  parts::CompactionDescription description;
  description.name = name;
  description.shader = {.path = shader};
  gpu::Specialisation own;
  own.set(kIdChoice, static_cast<std::int32_t>(choice));
  description.timed = raster.variant(false, own);
  description.counting = raster.variant(true, own);
  const VkDescriptorType bindings[] = {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                       VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};
  description.bindings = parts::SurfaceRaster::bindings(bindings);
  return description;
}

} // namespace

std::uint32_t chunkOf(const gpu::Device& device) {
  const gpu::DeviceFacts& facts = device.facts();
  const auto width = static_cast<std::uint32_t>(parts::kDispatchWidth);
  const std::uint32_t rows = std::min(facts.maximumTotalTaskWorkgroups / width, facts.maximumTaskWorkgroups[1]);
  return std::min(rows, 1u << 12) * width;
}

parts::Compaction makeBlockList(gpu::Device& device, const parts::SurfaceRaster& raster, const std::string& name,
                                Choice choice, std::uint32_t blocks) {
  parts::CompactionDescription description =
      describe(raster, "direct_rasterization/choose_blocks.comp.glsl", name, choice);
  description.items = blocks;
  description.chunk = chunkOf(device);
  return {device, description};
}

parts::Compaction makeRegionList(gpu::Device& device, const parts::SurfaceRaster& raster, std::uint32_t regions) {
  parts::CompactionDescription description =
      describe(raster, "direct_rasterization/choose_regions.comp.glsl", "regions", Choice::occupied);
  description.items = regions;
  description.perTask = kTaskThreads;
  description.chunk = chunkOf(device);
  return {device, description};
}

void record(const parts::Compaction& list, gpu::Commands& commands, const parts::SurfaceRaster& raster,
            const ChoiceInputs& inputs, bool counting) {
  const gpu::Resource own[] = {inputs.blocks, inputs.ranges, inputs.previous, inputs.visible};
  list.record(commands, raster.resources(own), counting);
}

void drawList(gpu::Commands& commands, const gpu::Pipeline& pipeline, const parts::SurfaceRaster& raster,
              const parts::Compaction& list, const gpu::BufferRange& blocks, std::span<const gpu::Resource> own,
              std::uint32_t chunk) {
  std::vector<gpu::Resource> drawn = {blocks, list.counts(), list.kept()};
  drawn.insert(drawn.end(), own.begin(), own.end());
  const std::vector<gpu::Resource> resources = raster.resources(drawn);
  for (std::uint32_t draw = 0; draw < list.draws(); ++draw) {
    const DrawConstants constants{.first = draw * chunk, .totalIndex = list.totalIndex()};
    commands.bind(pipeline, resources, gpu::bytesOf(constants));
    const gpu::BufferRange arguments = list.arguments(draw);
    commands.device().cmdDrawMeshTasksIndirect(commands.handle(), arguments.buffer, arguments.offset, 1,
                                               sizeof(glm::uvec3));
  }
}

} // namespace volmark::direct_rasterization
