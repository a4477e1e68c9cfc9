#include "indexed_draw.h"

#include <cstring>

namespace volmark::mesh_isosurface {

namespace {

void record(const Frame& frame, const parts::SurfaceRaster& raster, const gpu::Pipeline& pipeline,
            const IndexedMesh& mesh, gpu::Commands& commands) {
  if (mesh.triangleCount == 0) return;
  const MeshConstants constants{.vertices = wordsOf(mesh.vertices->address()), .meshlets = 0};
  commands.bind(pipeline, raster.resources({}), gpu::bytesOf(constants));
  vkCmdBindIndexBuffer(commands.handle(), mesh.indices->handle(), 0, VK_INDEX_TYPE_UINT32);
  vkCmdDrawIndexed(commands.handle(), 3 * mesh.triangleCount, static_cast<std::uint32_t>(frame.inputs.views.size()), 0,
                   0, 0);
}

template <class Element>
std::vector<Element> readBuffer(gpu::Device& device, const gpu::Buffer& buffer, std::size_t count) {
  const VkDeviceSize bytes = count * sizeof(Element);
  const gpu::Buffer host(device, {"", bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::MemoryAccess::readback});
  gpu::Commands commands(device);
  commands.begin();
  commands.barrier(gpu::kAnything, gpu::kTransferRead);
  const VkBufferCopy region{0, 0, bytes};
  vkCmdCopyBuffer(commands.handle(), buffer.handle(), host.handle(), 1, &region);
  commands.submit();
  commands.wait();
  std::vector<Element> elements(count);
  std::memcpy(elements.data(), host.mapped().data(), bytes);
  return elements;
}

} // namespace

glm::uvec2 wordsOf(VkDeviceAddress address) {
  return {static_cast<std::uint32_t>(address), static_cast<std::uint32_t>(address >> 32)};
}

SurfaceMesh readBack(gpu::Device& device, const IndexedMesh& mesh) {
  SurfaceMesh result;
  if (mesh.triangleCount == 0) return result;
  const auto vertices = readBuffer<Vertex>(device, *mesh.vertices, mesh.vertexCount);
  for (const Vertex& vertex : vertices) {
    result.positions.push_back(vertex.position);
    result.normals.push_back(vertex.normal);
  }
  result.triangles = readBuffer<glm::uvec3>(device, *mesh.indices, mesh.triangleCount);
  return result;
}

IndexedDraw::IndexedDraw(const parts::SurfaceRaster& raster, bool depthPrepass) : m_depthPrepass(depthPrepass) {
  const std::vector<gpu::ShaderSource> shaders = {{"mesh_isosurface/mesh.vert.glsl", VK_SHADER_STAGE_VERTEX_BIT, {}}};
  if (depthPrepass)
    m_depth = raster.makePipelines("depth prepass", shaders, {}, sizeof(MeshConstants), {}, parts::DepthUse::prepass);
  m_surface = raster.makePipelines("mesh", shaders, {}, sizeof(MeshConstants), {},
                                   depthPrepass ? parts::DepthUse::afterPrepass : parts::DepthUse::all);
}

void IndexedDraw::draw(const Frame& frame, const parts::SurfaceRaster& raster, const IndexedMesh& mesh,
                       Recorder& recorder) const {
  gpu::Commands& commands = recorder.gpu();
  if (m_depthPrepass) {
    const Pass pass = recorder.pass("depth_prepass");
    const gpu::Rendering rendering(commands, raster.depthOnly(frame, true));
    record(frame, raster, parts::SurfaceRaster::choose(m_depth, frame), mesh, commands);
  }
  const Pass pass = recorder.pass("draw_mesh");
  commands.barrier(gpu::kDrawWrite, gpu::kDrawWrite);
  gpu::RenderingDescription description = raster.rendering(frame, true);
  if (m_depthPrepass) description.depth.clear = false;
  const gpu::Rendering rendering(commands, description);
  raster.drawCaps(frame, recorder);
  record(frame, raster, parts::SurfaceRaster::choose(m_surface, frame), mesh, commands);
}

} // namespace volmark::mesh_isosurface
