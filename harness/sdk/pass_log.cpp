#include "sdk/pass_log.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <stdexcept>

namespace volmark {

double passClockMs() {
  // CLOCK_MONOTONIC on Linux.
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void PassLog::clear() {
  m_passes.clear();
  m_open = -1;
  m_updating = true;
}

int PassLog::begin(std::string_view name, bool onGpu) {
  if (isOpen())
    throw std::logic_error("pass \"" + std::string(name) + "\" begins inside pass \"" + pass(m_open).name +
                           "\": passes must not nest");
  m_open = static_cast<int>(m_passes.size());
  m_passes.push_back({std::string(name), onGpu, m_updating, passClockMs(), 0, -1, -1});
  return m_open;
}

void PassLog::end(int index) noexcept {
  assert(index == m_open);
  m_passes[static_cast<std::size_t>(index)].endMs = passClockMs();
  m_open = -1;
}

void addPassTime(FrameTimes& times, const RecordedPass& pass) {
  const auto same = std::find_if(times.passes.begin(), times.passes.end(), [&](const RecordedPass& other) {
    return other.name == pass.name && other.onGpu == pass.onGpu;
  });
  if (same == times.passes.end()) {
    times.passes.push_back(pass);
    return;
  }
  same->ms += pass.ms;
  same->hostMs += pass.hostMs;
}

} // namespace volmark
