// How often values occur in a volume.
#pragma once

#include "volmark/volume.h"

#include <cstdint>
#include <vector>

namespace volmark {

struct Histogram {
  Range range;                       ///< the data range; bins are equal parts of it, the last one closed
  std::vector<std::uint64_t> counts; ///< voxels of all time steps, by bin
  double mean = 0;                   ///< of the voxels, data's unit
};

/// At least one bin. A constant volume has all its voxels in the first.
Histogram histogramOf(const Volume& volume, int bins);

} // namespace volmark
