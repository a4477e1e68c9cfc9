#include "measure/clocks.h"

#include <array>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <string_view>
#include <sys/resource.h>
#include <unistd.h>

namespace volmark {

namespace {

// A frame that waited for a CPU for a larger share of its wall time is disturbed by pressure.
constexpr double kPressureShare = 0.05;

double readClockMs(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

// The first bytes of an open /proc file; empty if it isn't there. The kernel makes the text anew at offset 0.
template <std::size_t Size> std::string_view readStart(int file, std::array<char, Size>& buffer) {
  if (file < 0) return {};
  const ssize_t bytes = pread(file, buffer.data(), buffer.size() - 1, 0);
  if (bytes <= 0) return {};
  buffer[static_cast<std::size_t>(bytes)] = '\0';
  return {buffer.data(), static_cast<std::size_t>(bytes)};
}

// "some avg10=0.05 avg60=0.88 avg300=0.70 total=11006929\nfull ...": microseconds.
std::uint64_t totalOfSome(std::string_view text) {
  const std::string_view key = "total=";
  const auto place = text.find(key);
  if (!text.starts_with("some ") || place == std::string_view::npos) return 0;
  return std::strtoull(text.data() + place + key.size(), nullptr, 10);
}

// "cpu  user nice system idle iowait irq softirq steal ...": ticks of all CPUs.
std::uint64_t stealOfCpuLine(std::string_view text) {
  if (!text.starts_with("cpu ")) return 0;
  const char* place = text.data() + 4;
  std::uint64_t value = 0;
  for (int field = 0; field < 8; ++field) {
    char* end = nullptr;
    value = std::strtoull(place, &end, 10);
    if (end == place) return 0;
    place = end;
  }
  return value;
}

} // namespace

double monotonicMs() {
  return readClockMs(CLOCK_MONOTONIC);
}

double processCpuMs() {
  return readClockMs(CLOCK_PROCESS_CPUTIME_ID);
}

DisturbanceMonitor::DisturbanceMonitor()
    : m_pressure(open("/proc/pressure/cpu", O_RDONLY | O_CLOEXEC)), m_stat(open("/proc/stat", O_RDONLY | O_CLOEXEC)) {
}

DisturbanceMonitor::~DisturbanceMonitor() {
  if (m_pressure >= 0) close(m_pressure);
  if (m_stat >= 0) close(m_stat);
}

DisturbanceCounters DisturbanceMonitor::read() const {
  DisturbanceCounters counters;
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) counters.involuntarySwitches = static_cast<std::uint64_t>(usage.ru_nivcsw);
  std::array<char, 256> buffer;
  counters.pressureUs = totalOfSome(readStart(m_pressure, buffer));
  counters.stealTicks = stealOfCpuLine(readStart(m_stat, buffer));
  return counters;
}

std::string disturbanceBetween(const DisturbanceCounters& before, const DisturbanceCounters& after, double wallMs) {
  std::string reasons;
  const auto note = [&reasons](const char* reason) {
    if (!reasons.empty()) reasons += '+';
    reasons += reason;
  };
  if (after.involuntarySwitches > before.involuntarySwitches) note("switches");
  const double pressureMs =
      after.pressureUs > before.pressureUs ? static_cast<double>(after.pressureUs - before.pressureUs) * 1e-3 : 0;
  if (pressureMs > kPressureShare * wallMs) note("pressure");
  if (after.stealTicks > before.stealTicks) note("steal");
  return reasons;
}

} // namespace volmark
