// Clocks and the operating system's own counters of disturbance.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace volmark {

double monotonicMs();  ///< CLOCK_MONOTONIC
double processCpuMs(); ///< CLOCK_PROCESS_CPUTIME_ID: all threads of this process

/// Totals since the process (or machine) started. Fields that the system does not offer stay 0.
struct DisturbanceCounters {
  std::uint64_t involuntarySwitches = 0; ///< of all threads: getrusage(RUSAGE_SELF).ru_nivcsw
  std::uint64_t pressureUs = 0;          ///< /proc/pressure/cpu, some, total
  std::uint64_t stealTicks = 0;          ///< /proc/stat, cpu, steal
};

/// Reads the counters; keeps the files open, so that a read costs microseconds.
class DisturbanceMonitor {
public:
  DisturbanceMonitor();
  ~DisturbanceMonitor();
  DisturbanceMonitor(const DisturbanceMonitor&) = delete;
  DisturbanceMonitor& operator=(const DisturbanceMonitor&) = delete;
  DisturbanceCounters read() const;

private:
  int m_pressure = -1;
  int m_stat = -1;
};

/// Why a frame between two readings counts as disturbed: "switches", "pressure", "steal", joined by '+';
/// empty if it doesn't. A frame is disturbed by pressure when more than 5 % of its wall time was pressure.
std::string disturbanceBetween(const DisturbanceCounters& before, const DisturbanceCounters& after, double wallMs);

} // namespace volmark
