#include "extractor.h"

#include "volmark/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace volmark::mesh_isosurface {

namespace {

constexpr VkBufferUsageFlags kStorage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
constexpr VkBufferUsageFlags kSurface =
    kStorage | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT;
constexpr std::uint32_t kFirstVertices = 1 << 16; ///< room before anything is known

glm::ivec3 blocksOf(const Grid& grid) {
  return parts::blocksOf(parts::cellsOf(grid), glm::ivec3(kBlockEdge));
}

std::uint32_t countOf(const glm::ivec3& size) {
  return static_cast<std::uint32_t>(size.x) * static_cast<std::uint32_t>(size.y) * static_cast<std::uint32_t>(size.z);
}

parts::CompactionDescription describeChoice(const parts::SurfaceRaster& raster, std::uint32_t blocks) {
  const VkDescriptorType own[] = {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER};
  parts::CompactionDescription description;
  description.name = "occupied_blocks";
  description.shader.path = "mesh_isosurface/occupied_blocks.comp.glsl";
  description.timed = raster.variant(false);
  description.counting = raster.variant(true);
  description.bindings = parts::SurfaceRaster::bindings(own);
  description.items = blocks;
  description.chunk = blocks;
  return description;
}

gpu::Pipeline makePipeline(gpu::Device& device, const parts::SurfaceRaster& raster, bool count) {
  const VkDescriptorType own[] = {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                  VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                  VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};
  gpu::ComputePipelineDescription description;
  description.name = count ? "count surface" : "extract surface";
  description.shader.path = "mesh_isosurface/extract.comp.glsl";
  if (count) description.shader.macros.emplace_back("COUNT", "1");
  description.layout.bindings = parts::SurfaceRaster::bindings(own);
  description.layout.pushConstantBytes = sizeof(ExtractConstants);
  description.specialisation = raster.variant(false);
  return {device, description};
}

/// Room for `count` elements and a quarter more, if there is not yet enough.
void makeRoom(gpu::Device& device, gpu::Buffer& buffer, const char* name, std::uint64_t count, std::uint64_t bytes) {
  if (buffer && buffer.bytes() >= count * bytes) return;
  std::uint64_t wanted = std::max<std::uint64_t>(count + count / 4, kFirstVertices) * bytes;
  const std::uint64_t most = device.facts().maximumAllocationBytes;
  if (count * bytes > most)
    throw UnsupportedError(
        fmt::format("the surface needs {} bytes for {}, the device allows {} at once", count * bytes, name, most));
  wanted = std::min(wanted, most / bytes * bytes);
  if (buffer) device.waitIdle(); // earlier frames may still be drawing it
  buffer = {};
  buffer = gpu::Buffer(device, {name, wanted, kSurface});
}

} // namespace

Extractor::Extractor(gpu::Device& device, const Scene& scene, const parts::SurfaceRaster& raster)
    : m_device(&device), m_constants{.cells = scene.volume->grid().dims - 1, .blocks = blocksOf(scene.volume->grid())},
      m_blocks(countOf(m_constants.blocks)), m_ranges(device, *scene.volume, glm::ivec3(kBlockEdge), "block_ranges"),
      m_chosen(device, describeChoice(raster, m_blocks)), m_scan(device),
      m_vertexCounts(device, {"vertex_counts", (VkDeviceSize(m_blocks) + 1) * sizeof(uint), kStorage}),
      m_triangleCounts(device, {"triangle_counts", (VkDeviceSize(m_blocks) + 1) * sizeof(uint), kStorage}),
      m_unused(device, {"scan_draws", sizeof(glm::uvec3), kStorage}),
      m_totals(device,
               {"surface_totals", 2 * sizeof(uint), VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::MemoryAccess::readback}),
      m_count(makePipeline(device, raster, true)), m_write(makePipeline(device, raster, false)) {
  reserve();
}

void Extractor::reserve() {
  makeRoom(*m_device, m_vertices, "vertices", m_vertexCount, sizeof(Vertex));
  makeRoom(*m_device, m_indices, "indices", m_triangleCount, sizeof(glm::uvec3));
}

void Extractor::extract(gpu::Commands& commands, const parts::SurfaceRaster& raster) {
  const gpu::BufferRange blocks = commands.constants(m_constants);
  const gpu::Resource choice[] = {blocks, m_ranges.nodes()};
  m_chosen.record(commands, raster.resources(choice), false);

  const gpu::Resource own[] = {blocks, m_chosen.counts(), m_chosen.kept(), m_vertexCounts.range(),
                               m_triangleCounts.range()};
  const std::vector<gpu::Resource> resources = raster.resources(own);
  ExtractConstants constants{.vertices = {}, .indices = {}, .totalIndex = m_chosen.totalIndex()};
  commands.barrier(parts::kAnyShaderRead, gpu::kComputeWrite);
  commands.dispatchIndirect(m_count, resources, gpu::bytesOf(constants), m_chosen.arguments(0));
  commands.barrier(gpu::kComputeWrite, gpu::kComputeReadWrite);
  const parts::ScanConstants scan{.groups = 0,
                                  .sizeIndex = m_chosen.totalIndex(),
                                  .totalIndex = m_blocks,
                                  .chunk = m_blocks,
                                  .draws = 0,
                                  .perTask = 1};
  m_scan.record(commands, m_vertexCounts.range(), m_unused.range(), m_chosen.counts(), scan);
  m_scan.record(commands, m_triangleCounts.range(), m_unused.range(), m_chosen.counts(), scan);
  commands.barrier(gpu::kComputeWrite, gpu::kTransferRead);
  const VkBufferCopy vertexTotal{VkDeviceSize(m_blocks) * sizeof(uint), 0, sizeof(uint)};
  const VkBufferCopy triangleTotal{vertexTotal.srcOffset, sizeof(uint), sizeof(uint)};
  vkCmdCopyBuffer(commands.handle(), m_vertexCounts.handle(), m_totals.handle(), 1, &vertexTotal);
  vkCmdCopyBuffer(commands.handle(), m_triangleCounts.handle(), m_totals.handle(), 1, &triangleTotal);
  commands.submitAndWait();

  std::uint32_t totals[2];
  std::memcpy(totals, m_totals.mapped().data(), sizeof(totals));
  // The scan says kNoIndex where a sum is beyond 32 bits; a draw has as many indices at most.
  if (totals[0] == parts::kNoIndex || totals[1] >= parts::kNoIndex / 3) {
    m_vertexCount = m_triangleCount = 0;
    throw UnsupportedError("the surface has more vertices, or more corners of triangles, than 32 bits count");
  }
  m_vertexCount = totals[0];
  m_triangleCount = totals[1];
  reserve();
  constants.vertices = wordsOf(m_vertices.address());
  constants.indices = wordsOf(m_indices.address());
  // Earlier frames may still be drawing what is overwritten.
  commands.barrier(gpu::kAnything, gpu::kComputeReadWrite);
  commands.dispatchIndirect(m_write, resources, gpu::bytesOf(constants), m_chosen.arguments(0));
  commands.barrier(gpu::kComputeWrite,
                   {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                    VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_INDEX_READ_BIT | VK_ACCESS_2_TRANSFER_READ_BIT});
}

std::vector<gpu::MemoryItem> Extractor::surfaceMemory() const {
  return {m_vertices.memory(), m_indices.memory()};
}

std::optional<std::string> Extractor::whyUnsupported(const gpu::Device& device, const Volume& volume) {
  const glm::ivec3 blocks = blocksOf(volume.grid());
  const std::uint64_t bytes = (std::uint64_t(countOf(blocks)) + 1) * sizeof(uint);
  if (bytes > device.facts().maximumStorageBufferRange)
    return fmt::format("Counts of {} blocks need {} bytes, the device's storage buffers hold {}.", countOf(blocks),
                       bytes, device.facts().maximumStorageBufferRange);
  return parts::MinMaxGrid::whyUnsupported(device, volume, parts::octreeShape(blocks, parts::rootLevelOf(blocks)));
}

} // namespace volmark::mesh_isosurface
