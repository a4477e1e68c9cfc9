// An octree as the mip levels of one 3-D image: level 0 are the leaves, a node's children are the eight below it.
#pragma once

#include "structure.h"
#include "volmark/gpu/image.h"
#include "volmark/gpu/pipeline.h"

namespace volmark::empty_space_skipping {

/// Sizes of the levels that rays ask. Level sizes round up, so that no border is lost; as mip levels round down, the
/// leaf level is padded to a multiple of the topmost node.
struct OctreeShape {
  glm::ivec3 leaves;    ///< along each axis, padded
  glm::ivec3 blocks;    ///< of them, with voxels
  int rootLevel = 0;    ///< where one node holds all blocks
  int initialLevel = 0; ///< highest level that is asked, and made
};

/// Requires skippedLevels <= rootLevel.
OctreeShape octreeShape(const StructureSettings& settings, const Grid& grid);

/// Format of a node: as many bits as asked for, or two of the volume's own scalars.
VkFormat nodeFormat(const StructureSettings& settings, ScalarType type);

std::optional<std::string> whyOctreeUnsupported(const StructureSettings& settings, const Volume& volume,
                                                const gpu::Device& device);

class Octree final : public Structure {
public:
  Octree(gpu::Device& device, const Scene& scene, const gpu::VolumeTexture& volume, const StructureSettings& settings);

  bool dependsOnTransferFunction() const override { return m_settings.kind == StructureKind::booleanOctree; }
  void build(gpu::Commands& commands, const gpu::SampledImage& volume, const VisibleScalars& visible) override;
  std::vector<gpu::Resource> resources() const override;
  SkippingConstants constants(const VisibleScalars& kept, const VisibleScalars& beyond) const override;

  const OctreeShape& shape() const { return m_shape; }
  const gpu::Image& nodes() const { return m_nodes; }

private:
  StructureSettings m_settings;
  OctreeShape m_shape;
  BuildConstants m_constants;
  gpu::Image m_nodes;
  gpu::Sampler m_sampler;
  gpu::Pipeline m_leaves;
  gpu::Pipeline m_parents;
  bool m_built = false;
};

} // namespace volmark::empty_space_skipping
