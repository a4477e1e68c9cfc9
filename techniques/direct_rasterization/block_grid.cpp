#include "block_grid.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

namespace volmark::direct_rasterization {

namespace {

/// "8x8x4".
glm::ivec3 shapeOf(const std::string& text) {
  glm::ivec3 shape(0);
  std::sscanf(text.c_str(), "%dx%dx%d", &shape.x, &shape.y, &shape.z);
  return shape;
}

} // namespace

BlockSettings blockSettings(const ParameterValues& parameters) {
  const glm::ivec3 cells = shapeOf(parameters.text("block"));
  const std::string& granularity = parameters.text("granularity");
  return {.cells = cells, .region = granularity == "block" ? cells : shapeOf(granularity)};
}

std::optional<std::string> whySettingsUnsupported(const ParameterValues& parameters) {
  const BlockSettings settings = blockSettings(parameters);
  if (settings.region % settings.cells == glm::ivec3(0)) return std::nullopt;
  return fmt::format("granularity: found {}, allowed: multiples of the block {} along each axis, or \"block\".",
                     parameters.text("granularity"), parameters.text("block"));
}

BlockConstants blockConstants(const BlockSettings& settings, const Grid& grid, const gpu::Device& device) {
  BlockConstants constants{};
  // A volume of one voxel along an axis has no cells.
  constants.cells = grid.dims - 1;
  constants.blocks = parts::blocksOf(parts::cellsOf(grid), settings.cells);
  constants.perRegion = settings.region / settings.cells;
  constants.regions = parts::blocksOf(constants.blocks, constants.perRegion);
  constants.regionCells = settings.region;
  // What vertices snap by, and what rounding moves a corner by in the largest pictures.
  constants.grow = static_cast<float>(std::ldexp(1.0, -static_cast<int>(device.facts().subPixelBits)) + 0.01);
  return constants;
}

} // namespace volmark::direct_rasterization
