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
constexpr std::uint32_t kFirst = 1 << 16; ///< room before anything is known: vertices, triangles,
constexpr std::uint32_t kFirstBlocks = kFirst / 512;
constexpr std::uint64_t kRowBytes = kRowWords * sizeof(uint);

glm::ivec3 blocksOf(const Grid& grid) {
  return parts::blocksOf(parts::cellsOf(grid), glm::ivec3(kBlockEdge));
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

/// Room for `count` elements and a quarter more, `first` at least, if there is not yet enough.
void makeRoom(gpu::Device& device, gpu::Buffer& buffer, const char* name, std::uint64_t count, std::uint32_t first,
              std::uint64_t bytes) {
  if (buffer && buffer.bytes() >= count * bytes) return;
  std::uint64_t wanted = std::max<std::uint64_t>(count + count / 4, first) * bytes;
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
      m_blocks(parts::countOf(m_constants.blocks)),
      m_ranges(device, *scene.volume, glm::ivec3(kBlockEdge), "block_ranges"),
      m_chosen(device, describeChoice(raster, m_blocks)), m_scan(device),
      m_vertexCounts(device, {"vertex_counts", (VkDeviceSize(m_blocks) + 1) * sizeof(uint), kStorage}),
      m_triangleCounts(device, {"triangle_counts", (VkDeviceSize(m_blocks) + 1) * sizeof(uint), kStorage}),
      m_unused(device, {"scan_draws", sizeof(glm::uvec3), kStorage}),
      m_totals(device,
               {"surface_totals", 3 * sizeof(uint), VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::MemoryAccess::readback}),
      m_count(makePipeline(device, raster, true)), m_write(makePipeline(device, raster, false)) {
  reserve();
}

void Extractor::reserve() {
  makeRoom(*m_device, m_rows, "block_rows", m_chosenBlocks, kFirstBlocks, kRowBytes);
  makeRoom(*m_device, m_vertices, "vertices", m_vertexCount, kFirst, sizeof(Vertex));
  makeRoom(*m_device, m_indices, "indices", m_triangleCount, kFirst, sizeof(glm::uvec3));
}

void Extractor::extract(gpu::Commands& commands, const parts::SurfaceRaster& raster) {
  const gpu::BufferRange blocks = commands.constants(m_constants);
  const gpu::Resource choice[] = {blocks, m_ranges.nodes()};
  m_chosen.record(commands, raster.resources(choice), false);

  const gpu::Resource own[] = {blocks, m_chosen.counts(), m_chosen.kept(), m_vertexCounts.range(),
                               m_triangleCounts.range()};
  const std::vector<gpu::Resource> resources = raster.resources(own);
  count(commands, resources);
  const bool hadRoom = std::uint64_t(m_chosenBlocks) * kRowBytes <= m_rows.bytes();
  reserve();
  if (!hadRoom) count(commands, resources);

  // Earlier frames may still be drawing what is overwritten.
  commands.barrier(gpu::kAnything, gpu::kComputeReadWrite);
  const ExtractConstants constants = this->constants();
  commands.dispatchIndirect(m_write, resources, gpu::bytesOf(constants), m_chosen.arguments(0));
  commands.barrier(gpu::kComputeWrite,
                   {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                    VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_INDEX_READ_BIT | VK_ACCESS_2_TRANSFER_READ_BIT});
}

ExtractConstants Extractor::constants() const {
  return {.vertices = wordsOf(m_vertices.address()),
          .indices = wordsOf(m_indices.address()),
          .rows = wordsOf(m_rows.address()),
          .rowBlocks = static_cast<uint>(m_rows.bytes() / kRowBytes),
          .totalIndex = m_chosen.totalIndex()};
}

void Extractor::count(gpu::Commands& commands, std::span<const gpu::Resource> resources) {
  commands.barrier(parts::kAnyShaderRead, gpu::kComputeWrite);
  const ExtractConstants constants = this->constants();
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
  const std::pair<VkBuffer, VkDeviceSize> sources[] = {{m_vertexCounts.handle(), m_blocks},
                                                       {m_triangleCounts.handle(), m_blocks},
                                                       {m_chosen.counts().buffer, m_chosen.totalIndex()}};
  for (std::size_t i = 0; i < std::size(sources); ++i) {
    const VkBufferCopy copy{sources[i].second * sizeof(uint), i * sizeof(uint), sizeof(uint)};
    vkCmdCopyBuffer(commands.handle(), sources[i].first, m_totals.handle(), 1, &copy);
  }
  commands.submitAndWait();

  std::uint32_t totals[3];
  std::memcpy(totals, m_totals.mapped().data(), sizeof(totals));
  m_vertexCount = m_triangleCount = 0;
  // The scan says kNoIndex where a sum is beyond 32 bits; a draw has as many indices at most.
  if (totals[0] == parts::kNoIndex || totals[1] >= parts::kNoIndex / 3)
    throw UnsupportedError("the surface has more vertices, or more corners of triangles, than 32 bits count");
  m_vertexCount = totals[0];
  m_triangleCount = totals[1];
  m_chosenBlocks = totals[2];
}

std::vector<gpu::MemoryItem> Extractor::surfaceMemory() const {
  return {m_rows.memory(), m_vertices.memory(), m_indices.memory()};
}

std::optional<std::string> Extractor::whyUnsupported(const gpu::Device& device, const Volume& volume) {
  const glm::ivec3 blocks = blocksOf(volume.grid());
  const std::uint64_t bytes = (std::uint64_t(parts::countOf(blocks)) + 1) * sizeof(uint);
  if (bytes > device.facts().maximumStorageBufferRange)
    return fmt::format("Counts of {} blocks need {} bytes, the device's storage buffers hold {}.",
                       parts::countOf(blocks), bytes, device.facts().maximumStorageBufferRange);
  return parts::MinMaxGrid::whyUnsupported(device, volume, parts::octreeShape(blocks, parts::rootLevelOf(blocks)));
}

} // namespace volmark::mesh_isosurface
