#include "octree.h"

#include "parts/min_max_grid.h"
#include "volmark/gpu/volume_texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cassert>

namespace volmark::empty_space_skipping {

namespace {

/// "r32ui" and so on: the layout qualifier of a format.
const char* qualifierOf(VkFormat format) {
  switch (format) {
  case VK_FORMAT_R8_UINT: return "r8ui";
  case VK_FORMAT_R16_UINT: return "r16ui";
  case VK_FORMAT_R32_UINT: return "r32ui";
  case VK_FORMAT_R32G32_UINT: return "rg32ui";
  default: return "rgba32ui";
  }
}

std::uint64_t bytesOf(VkFormat format) {
  switch (format) {
  case VK_FORMAT_R8_UINT: return 1;
  case VK_FORMAT_R16_UINT: return 2;
  case VK_FORMAT_R32_UINT: return 4;
  case VK_FORMAT_R32G32_UINT: return 8;
  default: return 16;
  }
}

gpu::Pipeline builder(gpu::Device& device, const char* file, const StructureSettings& settings, VkFormat format,
                      std::vector<VkDescriptorType> bindings, bool cooperative) {
  return {device, gpu::ComputePipelineDescription{
                      .name = file,
                      .shader = {.path = std::string("empty_space_skipping/") + file,
                                 .macros = {{macroOf(settings.kind), "1"}, {"NODE_FORMAT", qualifierOf(format)}}},
                      .layout = {.bindings = std::move(bindings), .pushConstantBytes = sizeof(BuildConstants)},
                      .specialisation = gpu::Specialisation().set(kIdCooperative, cooperative)}};
}

} // namespace

parts::OctreeShape octreeShapeOf(const StructureSettings& settings, const Grid& grid) {
  const glm::ivec3 cells = cellsOf(grid, settings.voxelBlocks);
  return parts::octreeShape(parts::blocksOf(cells, glm::ivec3(settings.blockEdge)), settings.skippedLevels);
}

VkFormat nodeFormat(const StructureSettings& settings) {
  if (settings.kind == StructureKind::labelOctree) return VK_FORMAT_R32G32B32A32_UINT;
  if (settings.kind != StructureKind::bitfieldOctree) return VK_FORMAT_R8_UINT;
  switch (settings.bits) {
  case 8: return VK_FORMAT_R8_UINT;
  case 16: return VK_FORMAT_R16_UINT;
  case 32: return VK_FORMAT_R32_UINT;
  case 64: return VK_FORMAT_R32G32_UINT;
  default: return VK_FORMAT_R32G32B32A32_UINT;
  }
}

std::optional<std::string> whyOctreeUnsupported(const StructureSettings& settings, const Volume& volume,
                                                const gpu::Device& device) {
  const glm::ivec3 cells = cellsOf(volume.grid(), settings.voxelBlocks);
  const int rootLevel = parts::rootLevelOf(parts::blocksOf(cells, glm::ivec3(settings.blockEdge)));
  if (settings.skippedLevels && *settings.skippedLevels > rootLevel)
    return fmt::format(
        "initial_level: found {}, allowed: at most {}, the level of the leaves of this octree (leaf {}).",
        *settings.skippedLevels, rootLevel, settings.blockEdge);
  const parts::OctreeShape shape = octreeShapeOf(settings, volume.grid());
  if (settings.kind == StructureKind::minMaxOctree) return parts::MinMaxGrid::whyUnsupported(device, volume, shape);
  const std::uint64_t leafBytes = bytesOf(nodeFormat(settings));
  const std::uint64_t bytes = leafBytes * shape.nodeCount();
  const std::uint64_t most = device.facts().maximumAllocationBytes;
  if (bytes > most)
    return fmt::format("The octree ({} x {} x {} leaves of {} bytes) needs {} bytes, the device allows {} at once.",
                       shape.leaves.x, shape.leaves.y, shape.leaves.z, leafBytes, bytes, most);
  return std::nullopt;
}

SkippingConstants octreeConstants(const StructureSettings& settings, const parts::OctreeShape& shape) {
  SkippingConstants constants{};
  constants.blockShift = std::countr_zero(static_cast<unsigned>(settings.blockEdge));
  constants.initialLevel = shape.initialLevel;
  return constants;
}

Octree::Octree(gpu::Device& device, const Scene& scene, const gpu::VolumeTexture& volume,
               const StructureSettings& settings)
    : m_settings(settings), m_shape(octreeShapeOf(settings, scene.volume->grid())),
      m_constants(buildConstants(scene, volume, settings)) {
  const VkFormat format = nodeFormat(settings);
  m_nodes = gpu::Image(
      device, {.name = settings.kind == StructureKind::labelOctree ? "label_octree" : "octree",
               .type = VK_IMAGE_TYPE_3D,
               .format = format,
               .extent = {static_cast<std::uint32_t>(m_shape.leaves.x), static_cast<std::uint32_t>(m_shape.leaves.y),
                          static_cast<std::uint32_t>(m_shape.leaves.z)},
               .mipLevels = static_cast<std::uint32_t>(m_shape.initialLevel) + 1,
               .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
  m_sampler = gpu::Sampler(device, VK_FILTER_NEAREST);
  std::vector<VkDescriptorType> bindings = {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                            VK_DESCRIPTOR_TYPE_STORAGE_IMAGE};
  m_parents = builder(device, "octree_parents.comp.glsl", settings, format, bindings, false);
  if (dependsOnTransferFunction()) bindings.push_back(VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
  m_leaves = builder(device, "octree_leaves.comp.glsl", settings, format, bindings,
                     parts::isCooperative(glm::ivec3(settings.blockEdge)));
}

void Octree::build(gpu::Commands& commands, const gpu::SampledImage& volume, const VisibleScalars& visible) {
  // Earlier frames may still be reading.
  commands.transition(m_nodes, m_built ? VK_IMAGE_LAYOUT_GENERAL : VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL,
                      gpu::kComputeRead, gpu::kComputeWrite);
  m_built = true;
  BuildConstants constants = m_constants;
  constants.nodes = m_shape.leaves;
  constants.tableEntries = visible.entries();
  std::vector<gpu::Resource> leaves = {volume, gpu::StorageImage{m_nodes.levelView(0)}};
  if (dependsOnTransferFunction()) leaves.emplace_back(visibleBuffer(commands, visible));
  commands.dispatch(m_leaves, leaves, gpu::bytesOf(constants),
                    parts::rangeGroups(m_shape.leaves, parts::isCooperative(glm::ivec3(m_settings.blockEdge))));
  for (int level = 1; level <= m_shape.initialLevel; ++level) {
    commands.barrier(gpu::kComputeWrite, gpu::kComputeReadWrite);
    constants.nodes = m_shape.leaves >> level;
    const auto index = static_cast<std::uint32_t>(level);
    const gpu::Resource nodes[] = {
        gpu::SampledImage{m_nodes.levelView(index - 1), m_sampler.handle(), VK_IMAGE_LAYOUT_GENERAL},
        gpu::StorageImage{m_nodes.levelView(index)}};
    commands.dispatch(m_parents, nodes, gpu::bytesOf(constants), parts::rangeGroups(constants.nodes, false));
  }
  commands.barrier(gpu::kComputeWrite, gpu::kComputeRead);
}

std::vector<gpu::Resource> Octree::resources() const {
  return {gpu::SampledImage{m_nodes.view(), m_sampler.handle(), VK_IMAGE_LAYOUT_GENERAL}};
}

SkippingConstants Octree::constants(const VisibleScalars& kept, const VisibleScalars& beyond) const {
  SkippingConstants constants = octreeConstants(m_settings, m_shape);
  if (m_settings.kind == StructureKind::bitfieldOctree) {
    constants.mask = kept.mask(m_settings.bits);
    constants.maskBeyond = beyond.mask(m_settings.bits);
  }
  return constants;
}

} // namespace volmark::empty_space_skipping
