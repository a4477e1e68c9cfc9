// Smallest and largest voxel of blocks of cells, and of their parents: one two-channel 3-D image, a mip level for each
// level.
#pragma once

#include "parts/octree_shape.h"
#include "parts/shared.h"
#include "volmark/gpu/commands.h"
#include "volmark/gpu/image.h"
#include "volmark/gpu/pipeline.h"

#include <optional>
#include <string>

namespace volmark::parts {

class MinMaxGrid {
public:
  /// Level 0 has a node for each block of `blockCells`, in texel values of the volume. Pipelines and memory; throws
  /// UnsupportedError.
  MinMaxGrid(gpu::Device& device, const Volume& volume, const glm::ivec3& blockCells, const OctreeShape& shape,
             const char* name);
  /// One level.
  MinMaxGrid(gpu::Device& device, const Volume& volume, const glm::ivec3& blockCells, const char* name);

  /// Records all levels; they are visible to all shaders afterwards.
  void build(gpu::Commands& commands, const gpu::SampledImage& volume);

  /// To be fetched from.
  gpu::SampledImage nodes() const { return {m_nodes.view(), m_sampler.handle(), VK_IMAGE_LAYOUT_GENERAL}; }
  const gpu::Image& image() const { return m_nodes; }
  const OctreeShape& shape() const { return m_shape; }

  /// Why a device can't hold it (one sentence), or nothing.
  static std::optional<std::string> whyUnsupported(const gpu::Device& device, const Volume& volume,
                                                   const OctreeShape& shape);

private:
  OctreeShape m_shape;
  MinMaxConstants m_constants;
  bool m_cooperative;
  bool m_built = false;
  gpu::Image m_nodes;
  gpu::Sampler m_sampler;
  gpu::Pipeline m_leaves;
  gpu::Pipeline m_parents;
};

/// Blocks that are large enough for a workgroup of invocations.
bool isCooperative(const glm::ivec3& blockCells);
/// Workgroups for a grid of blocks, one a block or one an invocation.
glm::uvec3 rangeGroups(const glm::ivec3& blocks, bool cooperative);

} // namespace volmark::parts
