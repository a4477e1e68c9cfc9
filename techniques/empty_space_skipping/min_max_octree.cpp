#include "min_max_octree.h"

#include "octree.h"

namespace volmark::empty_space_skipping {

MinMaxOctree::MinMaxOctree(gpu::Device& device, const Volume& volume, const StructureSettings& settings)
    : m_settings(settings),
      m_grid(device, volume, glm::ivec3(settings.blockEdge), octreeShapeOf(settings, volume.grid()), "octree") {
}

SkippingConstants MinMaxOctree::constants(const VisibleScalars&, const VisibleScalars&) const {
  return octreeConstants(m_settings, m_grid.shape());
}

} // namespace volmark::empty_space_skipping
