// A transfer function as what the shader reads for one step of a ray.
#pragma once

#include "volmark/transfer_function.h"

#include <glm/glm.hpp>

#include <vector>

namespace volmark::parts {

struct TransferTable {
  int width = 0;
  int height = 0;                 ///< 1, or width if pre-integrated
  std::vector<glm::vec4> entries; ///< row-major
  /// No opacity where all scalars of a step are <= visibleLow, or all are >= visibleHigh.
  float visibleLow = 0;
  float visibleHigh = 1;
};

/// Entry i, of `width`: whether a scalar that is looked up there, or between it and a neighbour, can show. Of a
/// pre-integrated table that is opacity anywhere up to the neighbours.
std::vector<bool> visibleEntries(const TransferTable& table);

/// `size` straight colours and opacities of a step of `stepVoxels` voxel lengths; the entry nearest to a
/// scalar holds for it. `size` >= 2.
TransferTable postClassifiedTable(const TransferFunction& function, int size, double stepVoxels);

/// `size` * `size` premultiplied colours and opacities of a slab `stepVoxels` long, column front, row back, to
/// be interpolated linearly. `size` >= 2.
TransferTable preintegratedTable(const TransferFunction& function, int size, double stepVoxels);

} // namespace volmark::parts
