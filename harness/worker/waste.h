// Work that nobody needs, on request: tests of the gate ask for a slowdown of known size.
#pragma once

#include <cstdint>

namespace volmark {

/// Reads the environment once. VOLMARK_WASTE_TIME=0.05: that share of each frame's time, on as many threads as the
/// frame kept busy, so that wall and processor time grow alike. VOLMARK_WASTE_INSTRUCTIONS=1000: about so many
/// instructions a frame. Unset: nothing.
class Waste {
public:
  Waste();
  /// At the end of a frame that took so long.
  void spend(double wallMs, double cpuMs) const;

private:
  double m_share = 0;
  std::uint64_t m_instructions = 0;
};

} // namespace volmark
