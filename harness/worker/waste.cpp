#include "worker/waste.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <thread>
#include <vector>

namespace volmark {

namespace {

double threadCpuMs() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

void spinFor(double cpuMs) {
  const double end = threadCpuMs() + cpuMs;
  while (threadCpuMs() < end) {
  }
}

double variable(const char* name) {
  const char* text = std::getenv(name);
  return text ? std::strtod(text, nullptr) : 0;
}

} // namespace

Waste::Waste()
    : m_share(variable("VOLMARK_WASTE_TIME")),
      m_instructions(static_cast<std::uint64_t>(variable("VOLMARK_WASTE_INSTRUCTIONS"))) {
}

void Waste::spend(double wallMs, double cpuMs) const {
  if (m_share > 0 && wallMs > 0) {
    const int threads = std::clamp(static_cast<int>(std::lround(cpuMs / wallMs)), 1, 256);
    const double eachMs = m_share * cpuMs / threads;
    std::vector<std::thread> others;
    for (int i = 1; i < threads; ++i)
      others.emplace_back(spinFor, eachMs);
    spinFor(eachMs);
    for (std::thread& other : others)
      other.join();
  }
  // Load, add, store; count, compare, jump.
  volatile std::uint64_t sink = 0;
  for (std::uint64_t i = 0; i < m_instructions / 6; ++i)
    sink = sink + 1;
}

} // namespace volmark
