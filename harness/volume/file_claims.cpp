#include "volume/file_claims.h"

#include "volmark/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace volmark {

void checkClaimedSize(const std::string& place, const FileClaim& claim, std::uint64_t maximumBytes) {
  std::uint64_t bytes = claim.scalarBytes;
  bool fits = true;
  for (const int count : {claim.dims.x, claim.dims.y, claim.dims.z, claim.timeSteps}) {
    const auto factor = static_cast<std::uint64_t>(std::max(count, 0));
    fits = fits && factor > 0 && bytes <= std::numeric_limits<std::uint64_t>::max() / factor;
    bytes *= factor;
  }
  if (fits && bytes <= maximumBytes) return;
  throw InputError(fmt::format("{}: found {} x {} x {} voxels of {} bytes, {} time step{}, allowed: {} bytes in all",
                               place, claim.dims.x, claim.dims.y, claim.dims.z, claim.scalarBytes, claim.timeSteps,
                               claim.timeSteps == 1 ? "" : "s", maximumBytes));
}

} // namespace volmark
