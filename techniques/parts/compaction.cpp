#include "parts/compaction.h"

#include "parts/marcher.h"

namespace volmark::parts {

namespace {

constexpr VkBufferUsageFlags kStorage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT;

std::uint32_t dividedUp(std::uint32_t a, std::uint32_t b) {
  return (a + b - 1) / b;
}

gpu::Pipeline makePipeline(gpu::Device& device, const CompactionDescription& description, bool count, bool counting) {
  gpu::ComputePipelineDescription result;
  result.name = description.name + (count ? " count" : " write");
  result.shader = description.shader;
  result.shader.macros.emplace_back("COUNTS_BINDING", std::to_string(description.bindings.size()));
  if (count) result.shader.macros.emplace_back("COUNT", "1");
  result.layout.bindings = description.bindings;
  result.layout.bindings.insert(result.layout.bindings.end(), 2, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
  result.layout.pushConstantBytes = sizeof(CompactConstants);
  result.specialisation = counting ? description.counting : description.timed;
  return {device, result};
}

} // namespace

glm::uvec3 rowsOf(std::uint32_t groups) {
  return {std::min(groups, static_cast<std::uint32_t>(kDispatchWidth)), dividedUp(groups, kDispatchWidth), 1};
}

Scan::Scan(gpu::Device& device) {
  registerPartsShaders();
  m_pipeline = {device, gpu::ComputePipelineDescription{.name = "scan",
                                                        .shader = {.path = "parts/compact_scan.comp.glsl"},
                                                        .layout = {.bindings = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                                                                VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                                                                VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
                                                                   .pushConstantBytes = sizeof(ScanConstants)}}};
}

void Scan::record(gpu::Commands& commands, const gpu::BufferRange& counts, const gpu::BufferRange& arguments,
                  const gpu::BufferRange& sizes, const ScanConstants& constants) const {
  const gpu::Resource resources[] = {counts, arguments, sizes};
  commands.dispatch(m_pipeline, resources, gpu::bytesOf(constants), {1, 1, 1});
}

Compaction::Compaction(gpu::Device& device, const CompactionDescription& description)
    : m_description(description), m_groups(dividedUp(description.items, kCompactGroup)),
      m_draws(dividedUp(description.items, description.chunk)),
      m_counts(device, {description.name + " counts", (VkDeviceSize(m_groups) + 1) * sizeof(uint), kStorage}),
      m_kept(device, {description.name, VkDeviceSize(description.items) * sizeof(uint), kStorage}),
      m_arguments(device, {description.name + " draws", VkDeviceSize(m_draws) * sizeof(glm::uvec3),
                           kStorage | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT}),
      m_count(makePipeline(device, description, true, false)), m_write(makePipeline(device, description, false, false)),
      m_writeCounting(makePipeline(device, description, false, true)), m_scan(device) {
}

void Compaction::record(gpu::Commands& commands, std::span<const gpu::Resource> resources, bool counting) const {
  const CompactConstants constants{m_description.items};
  std::vector<gpu::Resource> all(resources.begin(), resources.end());
  all.emplace_back(m_counts.range());
  all.emplace_back(m_kept.range());
  const glm::uvec3 groups = rowsOf(m_groups);
  // Earlier draws may still be reading.
  commands.barrier(kAnyShaderRead, gpu::kComputeWrite);
  commands.dispatch(m_count, all, gpu::bytesOf(constants), groups);
  commands.barrier(gpu::kComputeWrite, gpu::kComputeReadWrite);
  m_scan.record(commands, m_counts.range(), m_arguments.range(), m_counts.range(),
                {.groups = m_groups,
                 .sizeIndex = kNoIndex,
                 .totalIndex = m_groups,
                 .chunk = m_description.chunk,
                 .draws = m_draws,
                 .perTask = m_description.perTask});
  commands.barrier(gpu::kComputeWrite, gpu::kComputeReadWrite);
  commands.dispatch(counting ? m_writeCounting : m_write, all, gpu::bytesOf(constants), groups);
  commands.barrier(gpu::kComputeWrite, kAnyShaderRead);
}

gpu::BufferRange Compaction::arguments(std::uint32_t draw) const {
  return {m_arguments.handle(), VkDeviceSize(draw) * sizeof(glm::uvec3), sizeof(glm::uvec3)};
}

} // namespace volmark::parts
