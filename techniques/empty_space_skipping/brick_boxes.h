// Boxes around bricks that the transfer function shows, in an acceleration structure for ray queries.
#pragma once

#include "box_tree.h"
#include "structure.h"

namespace volmark::empty_space_skipping {

std::optional<std::string> whyBrickBoxesUnsupported(const StructureSettings& settings, const Volume& volume,
                                                    const gpu::Device& device);

/// Bricks of blockEdge cells, in Morton order: a tree that a driver makes in the order of its input is then a good one.
class BrickBoxes final : public Structure {
public:
  BrickBoxes(gpu::Device& device, const Scene& scene, const StructureSettings& settings);

  bool dependsOnTransferFunction() const override { return true; }
  void prepareBuild(int timeStep, const VisibleScalars& visible) override;
  void build(gpu::Commands& commands, const gpu::SampledImage& volume, const VisibleScalars& visible) override;
  std::vector<gpu::Resource> resources() const override;
  SkippingConstants constants(const VisibleScalars& kept, const VisibleScalars& beyond) const override;

  /// Of the last build, in the tree's order.
  const std::vector<BrickBox>& boxes() const { return m_visible; }

private:
  struct Brick {
    glm::ivec3 place; ///< in bricks
    float low, high;  ///< normalised scalars of its voxels
  };
  void findRanges(int timeStep);

  Scene m_scene;
  StructureSettings m_settings;
  std::vector<Brick> m_bricks; ///< in Morton order
  std::optional<int> m_rangesOf;
  std::vector<BrickBox> m_visible;
  BoxTree m_tree;
};

} // namespace volmark::empty_space_skipping
