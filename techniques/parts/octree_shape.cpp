#include "parts/octree_shape.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace volmark::parts {

namespace {

/// Levels next to the root hold something visible in any picture worth drawing.
constexpr int kLevelsSkippedByDefault = 3;

} // namespace

std::uint64_t OctreeShape::nodeCount() const {
  std::uint64_t count = 0;
  for (int level = 0; level <= initialLevel; ++level) {
    const glm::ivec3 nodes = leaves >> level;
    count += static_cast<std::uint64_t>(nodes.x) * nodes.y * nodes.z;
  }
  return count;
}

glm::ivec3 cellsOf(const Grid& grid) {
  return glm::max(grid.dims - 1, glm::ivec3(1));
}

glm::ivec3 blocksOf(const glm::ivec3& cells, const glm::ivec3& edges) {
  return (cells + edges - 1) / edges;
}

std::uint32_t countOf(const glm::ivec3& size) {
  return static_cast<std::uint32_t>(size.x) * static_cast<std::uint32_t>(size.y) * static_cast<std::uint32_t>(size.z);
}

int rootLevelOf(const glm::ivec3& blocks) {
  const int most = std::max({blocks.x, blocks.y, blocks.z});
  return static_cast<int>(std::bit_width(static_cast<unsigned>(most - 1)));
}

OctreeShape octreeShape(const glm::ivec3& blocks, std::optional<int> skippedLevels) {
  OctreeShape shape;
  shape.blocks = blocks;
  shape.rootLevel = rootLevelOf(blocks);
  const int skipped = skippedLevels.value_or(std::min(kLevelsSkippedByDefault, shape.rootLevel));
  assert(skipped >= 0 && skipped <= shape.rootLevel);
  shape.initialLevel = shape.rootLevel - skipped;
  const int node = 1 << shape.initialLevel;
  shape.leaves = (blocks + node - 1) / node * node;
  return shape;
}

} // namespace volmark::parts
