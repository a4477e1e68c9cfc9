// Drawing an indexed mesh by the vertex pipeline.
#pragma once

#include "parts/surface_raster.h"
#include "shared.h"
#include "volmark/surface_mesh.h"

namespace volmark::mesh_isosurface {

struct IndexedMesh {
  const gpu::Buffer* vertices = nullptr; ///< Vertex
  const gpu::Buffer* indices = nullptr;  ///< 32 bits
  std::uint32_t vertexCount = 0;
  std::uint32_t triangleCount = 0;
};

/// Waits for the device.
SurfaceMesh readBack(gpu::Device& device, const IndexedMesh& mesh);

class IndexedDraw {
public:
  /// `depthPrepass`: depth alone is drawn first, so that no hidden fragment is shaded.
  IndexedDraw(const parts::SurfaceRaster& raster, bool depthPrepass);

  /// Passes "depth_prepass", if there is one, and "draw_mesh".
  void draw(const Frame& frame, const parts::SurfaceRaster& raster, const IndexedMesh& mesh, Recorder& recorder) const;

private:
  bool m_depthPrepass;
  parts::SurfacePipelines m_depth;
  parts::SurfacePipelines m_surface;
};

glm::uvec2 wordsOf(VkDeviceAddress address);

} // namespace volmark::mesh_isosurface
