#include "visible_regions.h"

namespace volmark::direct_rasterization {

namespace {

gpu::Buffer makeFlags(gpu::Device& device, const char* name, std::uint32_t regions) {
  return {device,
          {name, VkDeviceSize(regions) * sizeof(uint),
           VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT}};
}

gpu::Pipeline makeProxyPipeline(gpu::Device& device, const parts::SurfaceRaster& raster, int views) {
  const VkDescriptorType own[] = {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                  VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};
  gpu::GraphicsPipelineDescription description;
  description.name = "proxies";
  description.shaders = {
      {"direct_rasterization/proxies.mesh.glsl", VK_SHADER_STAGE_MESH_BIT_EXT, {{"VIEWS", std::to_string(views)}}},
      {"direct_rasterization/proxies.frag.glsl", VK_SHADER_STAGE_FRAGMENT_BIT, {}}};
  description.layout = {.bindings = parts::SurfaceRaster::bindings(own), .pushConstantBytes = sizeof(DrawConstants)};
  description.specialisation = raster.variant(false);
  description.depthFormat = parts::SurfaceRaster::kDepth;
  description.depthCompare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  description.depthWrite = false;
  description.representativeFragmentTest = true;
  return {device, description};
}

} // namespace

VisibleRegions::VisibleRegions(gpu::Device& device, const parts::SurfaceRaster& raster, std::uint32_t regions,
                               int views)
    : m_flags{makeFlags(device, "visible regions a", regions), makeFlags(device, "visible regions b", regions)},
      m_list(makeRegionList(device, raster, regions)), m_proxies(makeProxyPipeline(device, raster, views)) {
}

void VisibleRegions::beginFrame(gpu::Commands& commands) {
  m_current = 1 - m_current;
  constexpr gpu::Use anyShader{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                               VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT};
  commands.barrier(anyShader, gpu::kTransferWrite);
  commands.fill(m_flags[m_current], 0);
  if (m_empty) commands.fill(m_flags[1 - m_current], 0);
  m_empty = false;
  commands.barrier(gpu::kTransferWrite, anyShader);
}

void VisibleRegions::choose(gpu::Commands& commands, const parts::SurfaceRaster& raster, const ChoiceInputs& inputs,
                            bool counting) {
  record(m_list, commands, raster, inputs, counting);
}

void VisibleRegions::drawProxies(const Frame& frame, gpu::Commands& commands, const parts::SurfaceRaster& raster,
                                 const gpu::BufferRange& blocks) {
  commands.barrier(gpu::kDrawWrite, gpu::kDrawWrite);
  {
    const gpu::Rendering rendering(commands, raster.depthOnly(frame, false));
    const gpu::Resource own[] = {visible()};
    drawList(commands, m_proxies, raster, m_list, blocks, own, chunkOf(commands.device()));
  }
  commands.barrier({VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_ACCESS_2_SHADER_WRITE_BIT}, gpu::kComputeReadWrite);
}

} // namespace volmark::direct_rasterization
