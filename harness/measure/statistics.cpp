#include "measure/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace volmark {

namespace {

// Linear interpolation between the order statistics around (n - 1) * share: numpy's default method, with its
// rounding (from the nearer end).
double percentile(const std::vector<double>& ascending, double share) {
  const double place = static_cast<double>(ascending.size() - 1) * share;
  const auto below = static_cast<std::size_t>(place);
  const auto above = std::min(below + 1, ascending.size() - 1);
  const double weight = place - static_cast<double>(below);
  const double difference = ascending[above] - ascending[below];
  return weight < 0.5 ? ascending[below] + difference * weight : ascending[above] - difference * (1 - weight);
}

double meanOfSlowest(const std::vector<double>& ascending, std::size_t count) {
  return std::accumulate(ascending.rbegin(), ascending.rbegin() + static_cast<std::ptrdiff_t>(count), 0.0) /
         static_cast<double>(count);
}

double slowestCovering(const std::vector<double>& ascending, double share, double total) {
  double covered = 0;
  for (auto slowest = ascending.rbegin(); slowest != ascending.rend(); ++slowest) {
    covered += *slowest;
    if (covered >= share * total) return *slowest;
  }
  return ascending.front();
}

} // namespace

Statistics statisticsOf(std::span<const double> ms) {
  assert(!ms.empty());
  assert(std::all_of(ms.begin(), ms.end(), [](double value) { return std::isfinite(value) && value >= 0; }));

  std::vector<double> ascending(ms.begin(), ms.end());
  std::sort(ascending.begin(), ascending.end());
  const auto count = static_cast<double>(ascending.size());
  const double total = std::accumulate(ascending.begin(), ascending.end(), 0.0);

  Statistics statistics;
  statistics.count = static_cast<int>(ascending.size());
  statistics.meanMs = total / count;
  statistics.medianMs = percentile(ascending, 0.5);
  statistics.p99Ms = percentile(ascending, 0.99);
  statistics.low1AvgMs = meanOfSlowest(ascending, (ascending.size() + 99) / 100);
  statistics.low1IntegralMs = slowestCovering(ascending, 0.01, total);
  statistics.fps = 1000 / statistics.meanMs;
  statistics.clockMeanMs = count / std::accumulate(ascending.begin(), ascending.end(), 0.0,
                                                   [](double sum, double value) { return sum + 1 / value; });
  statistics.minMs = ascending.front();
  statistics.maxMs = ascending.back();
  return statistics;
}

} // namespace volmark
