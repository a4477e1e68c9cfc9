#include "parts/min_max_grid.h"

#include "parts/compaction.h"
#include "parts/marcher.h"

#include <fmt/format.h>

#include <limits>

namespace volmark::parts {

namespace {

struct NodeFormat {
  VkFormat format;
  const char* qualifier; ///< of an image in GLSL
  std::uint64_t bytes;
};

NodeFormat nodeFormat(ScalarType type) {
  switch (type) {
  case ScalarType::int8:
  case ScalarType::uint8: return {VK_FORMAT_R8G8_UNORM, "rg8", 2};
  case ScalarType::int16:
  case ScalarType::uint16: return {VK_FORMAT_R16G16_UNORM, "rg16", 4};
  case ScalarType::float32: break;
  }
  return {VK_FORMAT_R32G32_SFLOAT, "rg32f", 8};
}

gpu::Pipeline builder(gpu::Device& device, const char* path, ScalarType type, bool cooperative) {
  registerPartsShaders();
  return {device,
          gpu::ComputePipelineDescription{
              .name = path,
              .shader = {.path = path, .macros = {{"NODE_FORMAT", nodeFormat(type).qualifier}}},
              .layout = {.bindings = {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE},
                         .pushConstantBytes = sizeof(MinMaxConstants)},
              .specialisation = gpu::Specialisation().set(kIdCooperative, cooperative)}};
}

OctreeShape oneLevel(const Volume& volume, const glm::ivec3& blockCells) {
  const glm::ivec3 blocks = blocksOf(cellsOf(volume.grid()), blockCells);
  return octreeShape(blocks, rootLevelOf(blocks));
}

} // namespace

MinMaxGrid::MinMaxGrid(gpu::Device& device, const Volume& volume, const glm::ivec3& blockCells,
                       const OctreeShape& shape, const char* name)
    : m_shape(shape), m_constants{}, m_cooperative(isCooperative(blockCells)) {
  constexpr float largest = std::numeric_limits<float>::max();
  m_constants.dims = volume.grid().dims;
  m_constants.blockCells = blockCells;
  m_constants.blocks = shape.blocks;
  m_constants.nothing = volume.type() == ScalarType::float32 ? glm::vec2(largest, -largest) : glm::vec2(1, 0);
  m_nodes = gpu::Image(
      device, {.name = name,
               .type = VK_IMAGE_TYPE_3D,
               .format = nodeFormat(volume.type()).format,
               .extent = {static_cast<std::uint32_t>(shape.leaves.x), static_cast<std::uint32_t>(shape.leaves.y),
                          static_cast<std::uint32_t>(shape.leaves.z)},
               .mipLevels = static_cast<std::uint32_t>(shape.levels()),
               .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
  m_sampler = gpu::Sampler(device, VK_FILTER_NEAREST);
  m_leaves = builder(device, "parts/min_max_grid.comp.glsl", volume.type(), m_cooperative);
  if (shape.levels() > 1) m_parents = builder(device, "parts/min_max_parents.comp.glsl", volume.type(), false);
}

MinMaxGrid::MinMaxGrid(gpu::Device& device, const Volume& volume, const glm::ivec3& blockCells, const char* name)
    : MinMaxGrid(device, volume, blockCells, oneLevel(volume, blockCells), name) {
}

void MinMaxGrid::build(gpu::Commands& commands, const gpu::SampledImage& volume) {
  // Earlier frames may still be reading.
  commands.transition(m_nodes, m_built ? VK_IMAGE_LAYOUT_GENERAL : VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL,
                      kAnyShaderRead, gpu::kComputeWrite);
  m_built = true;
  MinMaxConstants constants = m_constants;
  constants.nodes = m_shape.leaves;
  const gpu::Resource leaves[] = {volume, gpu::StorageImage{m_nodes.levelView(0)}};
  commands.dispatch(m_leaves, leaves, gpu::bytesOf(constants), rangeGroups(m_shape.leaves, m_cooperative));
  for (int level = 1; level < m_shape.levels(); ++level) {
    commands.barrier(gpu::kComputeWrite, gpu::kComputeReadWrite);
    constants.nodes = m_shape.leaves >> level;
    const auto index = static_cast<std::uint32_t>(level);
    const gpu::Resource nodes[] = {
        gpu::SampledImage{m_nodes.levelView(index - 1), m_sampler.handle(), VK_IMAGE_LAYOUT_GENERAL},
        gpu::StorageImage{m_nodes.levelView(index)}};
    commands.dispatch(m_parents, nodes, gpu::bytesOf(constants), rangeGroups(constants.nodes, false));
  }
  commands.barrier(gpu::kComputeWrite, kAnyShaderRead);
}

std::optional<std::string> MinMaxGrid::whyUnsupported(const gpu::Device& device, const Volume& volume,
                                                      const OctreeShape& shape) {
  const std::uint64_t bytes = shape.nodeCount() * nodeFormat(volume.type()).bytes;
  const std::uint64_t most = device.facts().maximumAllocationBytes;
  if (bytes <= most) return std::nullopt;
  return fmt::format("The ranges of {} x {} x {} blocks need {} bytes, the device allows {} at once.", shape.leaves.x,
                     shape.leaves.y, shape.leaves.z, bytes, most);
}

bool isCooperative(const glm::ivec3& blockCells) {
  return blockCells.x * blockCells.y * blockCells.z >= 16 * 16 * 16;
}

glm::uvec3 rangeGroups(const glm::ivec3& blocks, bool cooperative) {
  return cooperative ? glm::uvec3(blocks) : glm::uvec3((blocks + kRangeGroup - 1) / kRangeGroup);
}

} // namespace volmark::parts
