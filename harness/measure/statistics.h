// The statistics of frame times, by the names of harness/README.md, section Measuring.
#pragma once

#include <span>
#include <vector>

namespace volmark {

struct Statistics {
  int count = 0;
  double meanMs = 0;
  double medianMs = 0;
  double p99Ms = 0;          ///< linear interpolation between order statistics (numpy's default)
  double low1AvgMs = 0;      ///< mean of the slowest ceil(n/100) frames
  double low1IntegralMs = 0; ///< slowest frames until they cover 1 % of the total time: the last one's time
  double fps = 0;            ///< 1000 / meanMs; infinite if all are 0
  double clockMeanMs = 0;    ///< 1 / mean(1/t): what a clock-driven orbit would have shown; 0 if one is 0
  double minMs = 0;
  double maxMs = 0;
};

/// `ms`: at least one value, all finite and >= 0 (asserted; an update without work takes 0 ms). The order of the
/// values doesn't matter, not even for rounding.
Statistics statisticsOf(std::span<const double> ms);

/// Under this many distinct poses a 1 % low is marked insufficient_frames.
inline constexpr int kPosesForLow1 = 299;

} // namespace volmark
