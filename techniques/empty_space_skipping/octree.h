// Octrees of bits as the mip levels of one 3-D image: level 0 are the leaves, a node's children are the eight below it.
#pragma once

#include "parts/octree_shape.h"
#include "structure.h"
#include "volmark/gpu/image.h"
#include "volmark/gpu/pipeline.h"

namespace volmark::empty_space_skipping {

/// Requires skippedLevels <= rootLevel.
parts::OctreeShape octreeShapeOf(const StructureSettings& settings, const Grid& grid);

/// Format of a node: as many bits as asked for.
VkFormat nodeFormat(const StructureSettings& settings);

std::optional<std::string> whyOctreeUnsupported(const StructureSettings& settings, const Volume& volume,
                                                const gpu::Device& device);

/// What rays need to know of any octree.
SkippingConstants octreeConstants(const StructureSettings& settings, const parts::OctreeShape& shape);

class Octree final : public Structure {
public:
  Octree(gpu::Device& device, const Scene& scene, const gpu::VolumeTexture& volume, const StructureSettings& settings);

  bool dependsOnTransferFunction() const override { return m_settings.kind == StructureKind::booleanOctree; }
  void build(gpu::Commands& commands, const gpu::SampledImage& volume, const VisibleScalars& visible) override;
  std::vector<gpu::Resource> resources() const override;
  SkippingConstants constants(const VisibleScalars& kept, const VisibleScalars& beyond) const override;

  const parts::OctreeShape& shape() const { return m_shape; }
  const gpu::Image& nodes() const { return m_nodes; }

private:
  StructureSettings m_settings;
  parts::OctreeShape m_shape;
  BuildConstants m_constants;
  gpu::Image m_nodes;
  gpu::Sampler m_sampler;
  gpu::Pipeline m_leaves;
  gpu::Pipeline m_parents;
  bool m_built = false;
};

} // namespace volmark::empty_space_skipping
