// The inputs used since the last reset: what replays repeat.
#pragma once

#include <cstddef>
#include <vector>

namespace volmark {

struct Trace {
  std::vector<double> phases;     ///< frame i since reset was drawn at phases[i]; warm-up included
  std::size_t lastOrbitBegin = 0; ///< first frame of the last timed orbit
};

} // namespace volmark
