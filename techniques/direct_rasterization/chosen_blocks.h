// Lists of blocks or regions, chosen on the GPU, and drawing what they name.
#pragma once

#include "parts/compaction.h"
#include "parts/surface_raster.h"
#include "shared.h"

namespace volmark::direct_rasterization {

/// What the choosing shaders are bound to.
struct ChoiceInputs {
  gpu::BufferRange blocks; ///< BlockConstants
  gpu::SampledImage ranges;
  gpu::BufferRange previous; ///< visible regions of the last frame
  gpu::BufferRange visible;  ///< and of this one
};

enum class Choice { occupied = kChooseOccupied, previous = kChoosePrevious, newlyVisible = kChooseNew };

/// Items of one draw, at most.
std::uint32_t chunkOf(const gpu::Device& device);

parts::Compaction makeBlockList(gpu::Device& device, const parts::SurfaceRaster& raster, const std::string& name,
                                Choice choice, std::uint32_t blocks);
parts::Compaction makeRegionList(gpu::Device& device, const parts::SurfaceRaster& raster, std::uint32_t regions);

void record(const parts::Compaction& list, gpu::Commands& commands, const parts::SurfaceRaster& raster,
            const ChoiceInputs& inputs, bool counting);

/// Records draws of all that is on the list: a workgroup each, or each perTask of them. `own`: resources behind the
/// list.
void drawList(gpu::Commands& commands, const gpu::Pipeline& pipeline, const parts::SurfaceRaster& raster,
              const parts::Compaction& list, const gpu::BufferRange& blocks, std::span<const gpu::Resource> own,
              std::uint32_t chunk);

} // namespace volmark::direct_rasterization
