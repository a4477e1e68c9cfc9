// Sizes of an octree that is stored as the mip levels of one 3-D image.
#pragma once

#include "volmark/volume.h"

#include <glm/glm.hpp>

#include <optional>

namespace volmark::parts {

/// Level sizes round up, so that no border is lost; as mip levels round down, the leaf level is padded to a multiple of
/// the topmost node.
struct OctreeShape {
  glm::ivec3 leaves;    ///< along each axis, padded
  glm::ivec3 blocks;    ///< of them, with voxels
  int rootLevel = 0;    ///< where one node holds all blocks
  int initialLevel = 0; ///< highest level that is asked, and made

  int levels() const { return initialLevel + 1; }
  /// Of all levels.
  std::uint64_t nodeCount() const;
};

/// Cells along each axis, at least one: what blocks are made of.
glm::ivec3 cellsOf(const Grid& grid);

/// Blocks of `edges` along each axis: rounded up.
glm::ivec3 blocksOf(const glm::ivec3& cells, const glm::ivec3& edges);

/// How many blocks that is, for sizes whose count is below 2^32.
std::uint32_t countOf(const glm::ivec3& size);

int rootLevelOf(const glm::ivec3& blocks);

/// `skippedLevels` below the root are never asked, at most rootLevelOf(blocks); absent: 3, or all but the leaves where
/// there are fewer (Faludi et al. 2021, section 4.3).
OctreeShape octreeShape(const glm::ivec3& blocks, std::optional<int> skippedLevels);

} // namespace volmark::parts
