// Extracts the isosurface into buffers on the GPU (Lorensen and Cline 1987; block-wise after Liu et al. 2016).
#pragma once

#include "indexed_draw.h"
#include "parts/compaction.h"
#include "parts/min_max_grid.h"
#include "parts/surface_raster.h"
#include "shared.h"

#include <optional>
#include <string>

namespace volmark::mesh_isosurface {

class Extractor {
public:
  Extractor(gpu::Device& device, const Scene& scene, const parts::SurfaceRaster& raster);

  /// When the time step has changed: which voxels blocks have.
  void buildRanges(gpu::Commands& commands, const gpu::SampledImage& volume) { m_ranges.build(commands, volume); }

  /// The surface of the level that `raster` was told of, in three steps: counts, waits for the totals, then makes room
  /// and writes. Counts again if there was no room for the blocks. Throws UnsupportedError when the device can't hold
  /// the surface.
  void extract(gpu::Commands& commands, const parts::SurfaceRaster& raster);

  /// What it extracted last.
  IndexedMesh mesh() const {
    return {
        .vertices = &m_vertices, .indices = &m_indices, .vertexCount = m_vertexCount, .triangleCount = m_triangleCount};
  }
  /// What the surface and its blocks add to the device's ledger now.
  std::vector<gpu::MemoryItem> surfaceMemory() const;

  static std::optional<std::string> whyUnsupported(const gpu::Device& device, const Volume& volume);

private:
  void reserve();
  ExtractConstants constants() const;
  void count(gpu::Commands& commands, std::span<const gpu::Resource> resources);

  gpu::Device* m_device;
  BlockConstants m_constants;
  std::uint32_t m_blocks;
  parts::MinMaxGrid m_ranges;
  parts::Compaction m_chosen;
  parts::Scan m_scan;
  gpu::Buffer m_vertexCounts; ///< of each chosen block; the total in the last word
  gpu::Buffer m_triangleCounts;
  gpu::Buffer m_unused; ///< the scan's arguments of draws
  gpu::Buffer m_totals; ///< vertices, triangles, blocks: read by the host
  gpu::Pipeline m_count;
  gpu::Pipeline m_write;
  gpu::Buffer m_rows; ///< inside voxels of the chosen blocks
  gpu::Buffer m_vertices;
  gpu::Buffer m_indices;
  std::uint32_t m_chosenBlocks = 0;
  std::uint32_t m_vertexCount = 0;
  std::uint32_t m_triangleCount = 0;
};

} // namespace volmark::mesh_isosurface
