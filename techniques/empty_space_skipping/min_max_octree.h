// The min-max octree of all families, for volume rendering.
#pragma once

#include "structure.h"

namespace volmark::empty_space_skipping {

class MinMaxOctree final : public Structure {
public:
  MinMaxOctree(gpu::Device& device, const Volume& volume, const StructureSettings& settings);

  bool dependsOnTransferFunction() const override { return false; }
  void build(gpu::Commands& commands, const gpu::SampledImage& volume, const VisibleScalars&) override {
    m_grid.build(commands, volume);
  }
  std::vector<gpu::Resource> resources() const override { return {m_grid.nodes()}; }
  SkippingConstants constants(const VisibleScalars& kept, const VisibleScalars& beyond) const override;

  const parts::MinMaxGrid& grid() const { return m_grid; }

private:
  StructureSettings m_settings;
  parts::MinMaxGrid m_grid;
};

} // namespace volmark::empty_space_skipping
