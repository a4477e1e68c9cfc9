#include "distance_map.h"

#include <fmt/format.h>

#include <bit>

namespace volmark::empty_space_skipping {

namespace {

std::uint64_t texelCount(const StructureSettings& settings, const Grid& grid) {
  const glm::ivec3 texels = parts::blocksOf(cellsOf(grid, false), glm::ivec3(settings.blockEdge));
  return static_cast<std::uint64_t>(texels.x) * texels.y * texels.z;
}

int octantsOf(const StructureSettings& settings) {
  return settings.kind == StructureKind::chebyshevMap ? 8 : 1;
}

gpu::Buffer texelBuffer(gpu::Device& device, const char* name, std::uint64_t texels) {
  return {device, {.name = name, .bytes = texels * sizeof(std::uint32_t), .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT}};
}

gpu::BufferRange whole(const gpu::Buffer& buffer) {
  return {buffer.handle()};
}

gpu::Pipeline transformer(gpu::Device& device, StructureKind kind, bool last) {
  gpu::ShaderSource shader{.path = "empty_space_skipping/distances.comp.glsl", .macros = {{macroOf(kind), "1"}}};
  if (last) shader.macros.emplace_back("LAST", "1");
  return {device, gpu::ComputePipelineDescription{.name = last ? "distances, last axis" : "distances",
                                                  .shader = shader,
                                                  .layout = {.bindings = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                                                          last ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE
                                                                               : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                                                          VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
                                                             .pushConstantBytes = sizeof(DistanceConstants)}}};
}

} // namespace

std::uint64_t distanceMapBytes(const StructureSettings& settings, const Grid& grid) {
  return texelCount(settings, grid) * static_cast<std::uint64_t>(octantsOf(settings));
}

std::optional<std::string> whyDistanceMapUnsupported(const StructureSettings& settings, const Volume& volume,
                                                     const gpu::Device& device) {
  const std::uint64_t bytes = texelCount(settings, volume.grid()) * sizeof(std::uint32_t);
  const std::uint64_t most = device.facts().maximumStorageBufferRange;
  if (bytes > most)
    return fmt::format("The distance transform needs storage buffers of {} bytes, the device allows {}.", bytes, most);
  return std::nullopt;
}

DistanceMap::DistanceMap(gpu::Device& device, const Scene& scene, const gpu::VolumeTexture& volume,
                         const StructureSettings& settings)
    : m_settings(settings), m_constants(buildConstants(scene, volume, settings)) {
  const std::uint64_t texels = texelCount(settings, scene.volume->grid());
  m_distances = gpu::Image(
      device,
      {.name = "distance_map",
       .type = VK_IMAGE_TYPE_3D,
       .format = VK_FORMAT_R8_UINT,
       .extent = {static_cast<std::uint32_t>(m_constants.blocks.x), static_cast<std::uint32_t>(m_constants.blocks.y),
                  static_cast<std::uint32_t>(m_constants.blocks.z * octantsOf(settings))},
       .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
  m_sampler = gpu::Sampler(device, VK_FILTER_NEAREST);
  m_occupied = texelBuffer(device, "occupancy", texels);
  m_alongX = texelBuffer(device, "distances_x", texels);
  m_alongY = texelBuffer(device, "distances_y", texels);
  m_occupancy = {
      device, gpu::ComputePipelineDescription{
                  .name = "occupancy",
                  .shader = {.path = "empty_space_skipping/occupancy.comp.glsl"},
                  .layout = {.bindings = {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                          VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
                             .pushConstantBytes = sizeof(BuildConstants)},
                  .specialisation =
                      gpu::Specialisation().set(kIdCooperative, parts::isCooperative(glm::ivec3(settings.blockEdge)))}};
  m_transform = transformer(device, settings.kind, false);
  m_lastTransform = transformer(device, settings.kind, true);
}

void DistanceMap::transform(gpu::Commands& commands, const DistanceConstants& constants, const gpu::Buffer& before,
                            const gpu::Buffer* after) const {
  const gpu::Resource written =
      after ? gpu::Resource(whole(*after)) : gpu::Resource(gpu::StorageImage{m_distances.view()});
  const gpu::Resource resources[] = {whole(before), written, whole(m_occupied)};
  commands.barrier(gpu::kComputeReadWrite, gpu::kComputeReadWrite);
  commands.dispatch(after ? m_transform : m_lastTransform, resources, gpu::bytesOf(constants),
                    parts::rangeGroups(constants.texels, false));
}

void DistanceMap::buildEuclidean(gpu::Commands& commands) {
  DistanceConstants constants{.texels = m_constants.blocks, .axis = 0, .first = 1, .blockEdge = m_settings.blockEdge};
  transform(commands, constants, m_occupied, &m_alongX);
  constants.first = 0;
  constants.axis = 1;
  transform(commands, constants, m_alongX, &m_alongY);
  constants.axis = 2;
  transform(commands, constants, m_alongY, nullptr);
}

void DistanceMap::buildChebyshev(gpu::Commands& commands) {
  // Octant o looks along +x if bit 0 is set, +y if bit 1 is, +z if bit 2 is.
  const auto along = [&](int axis, int towards) {
    return DistanceConstants{.texels = m_constants.blocks,
                             .axis = axis,
                             .direction = towards ? 1 : -1,
                             .first = axis == 0 ? 1 : 0,
                             .blockEdge = m_settings.blockEdge};
  };
  for (int x = 0; x < 2; ++x) {
    transform(commands, along(0, x), m_occupied, &m_alongX);
    for (int y = 0; y < 2; ++y) {
      transform(commands, along(1, y), m_alongX, &m_alongY);
      for (int z = 0; z < 2; ++z) {
        DistanceConstants last = along(2, z);
        last.firstSlice = (x + 2 * y + 4 * z) * m_constants.blocks.z;
        transform(commands, last, m_alongY, nullptr);
      }
    }
  }
}

void DistanceMap::build(gpu::Commands& commands, const gpu::SampledImage& volume, const VisibleScalars& visible) {
  // Earlier frames may still be reading.
  commands.transition(m_distances, m_built ? VK_IMAGE_LAYOUT_GENERAL : VK_IMAGE_LAYOUT_UNDEFINED,
                      VK_IMAGE_LAYOUT_GENERAL, gpu::kComputeRead, gpu::kComputeWrite);
  // Those of an earlier build read and write the buffers.
  commands.barrier(gpu::kComputeReadWrite, gpu::kComputeReadWrite);
  m_built = true;
  BuildConstants constants = m_constants;
  constants.nodes = m_constants.blocks;
  constants.tableEntries = visible.entries();
  const gpu::Resource resources[] = {volume, whole(m_occupied), visibleBuffer(commands, visible)};
  commands.dispatch(m_occupancy, resources, gpu::bytesOf(constants),
                    parts::rangeGroups(constants.blocks, parts::isCooperative(glm::ivec3(m_settings.blockEdge))));
  if (m_settings.kind == StructureKind::chebyshevMap)
    buildChebyshev(commands);
  else
    buildEuclidean(commands);
  commands.barrier(gpu::kComputeWrite, gpu::kComputeRead);
}

std::vector<gpu::Resource> DistanceMap::resources() const {
  return {gpu::SampledImage{m_distances.view(), m_sampler.handle(), VK_IMAGE_LAYOUT_GENERAL}};
}

SkippingConstants DistanceMap::constants(const VisibleScalars&, const VisibleScalars&) const {
  return {.blockShift = std::countr_zero(static_cast<unsigned>(m_settings.blockEdge))};
}

} // namespace volmark::empty_space_skipping
