// Which regions something may be seen of, in the last frame and in this one (Kreskowski et al. 2022, section 3.5).
#pragma once

#include "chosen_blocks.h"

namespace volmark::direct_rasterization {

class VisibleRegions {
public:
  /// `views`: of the picture.
  VisibleRegions(gpu::Device& device, const parts::SurfaceRaster& raster, std::uint32_t regions, int views);

  /// Nothing was visible in the last frame.
  void reset() { m_empty = true; }
  /// What was visible now was so in the last frame, and nothing is in this one yet.
  void beginFrame(gpu::Commands& commands);

  gpu::BufferRange previous() const { return m_flags[1 - m_current].range(); }
  gpu::BufferRange visible() const { return m_flags[m_current].range(); }

  /// Lists the regions that need a proxy; marks those that need none.
  void choose(gpu::Commands& commands, const parts::SurfaceRaster& raster, const ChoiceInputs& inputs, bool counting);
  /// Marks those whose proxy nothing drawn so far hides.
  void drawProxies(const Frame& frame, gpu::Commands& commands, const parts::SurfaceRaster& raster,
                   const gpu::BufferRange& blocks);

private:
  gpu::Buffer m_flags[2];
  int m_current = 0;
  bool m_empty = true;
  parts::Compaction m_list;
  gpu::Pipeline m_proxies;
};

} // namespace volmark::direct_rasterization
