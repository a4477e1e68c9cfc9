// Blocks of cells, the regions that hold them, and which voxels they have.
#pragma once

#include "parts/min_max_grid.h"
#include "shared.h"
#include "volmark/parameters.h"
#include "volmark/scene.h"

#include <optional>
#include <string>

namespace volmark::direct_rasterization {

struct BlockSettings {
  glm::ivec3 cells{8, 8, 4};  ///< of a block, along each axis
  glm::ivec3 region{8, 8, 8}; ///< cells of a region: what occlusion culling knows of
};

/// Reads the parameters block and granularity.
BlockSettings blockSettings(const ParameterValues& parameters);

/// Why blocks don't make regions (one sentence), or nothing.
std::optional<std::string> whySettingsUnsupported(const ParameterValues& parameters);

BlockConstants blockConstants(const BlockSettings& settings, const Grid& grid, const gpu::Device& device);

} // namespace volmark::direct_rasterization
