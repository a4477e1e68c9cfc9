#include "volmark/host_recorder.h"

#include "sdk/pass_log.h"

#include <stdexcept>

namespace volmark {

HostRecorder::HostRecorder() : m_log(std::make_unique<PassLog>()) {
}
HostRecorder::~HostRecorder() = default;

void HostRecorder::beginFrame() {
  m_log->clear();
  m_begin = m_updateDone = m_end = passClockMs();
}

void HostRecorder::markUpdateDone() {
  m_log->markUpdateDone();
  m_updateDone = passClockMs();
}

void HostRecorder::endFrame() {
  m_end = passClockMs();
}

FrameTimes HostRecorder::finish() {
  FrameTimes times;
  times.updateHostMs = m_updateDone - m_begin;
  times.drawHostMs = m_end - m_updateDone;
  for (const LoggedPass& pass : m_log->passes()) {
    const double ms = pass.endMs - pass.beginMs;
    addPassTime(times, {pass.name, false, ms, ms});
  }
  return times;
}

gpu::Commands& HostRecorder::gpu() {
  throw std::logic_error("a technique with needsGpu = false asked for a command buffer");
}

int HostRecorder::beginGpuPass(std::string_view name) {
  throw std::logic_error("a technique with needsGpu = false began the GPU pass \"" + std::string(name) + "\"");
}

int HostRecorder::beginHostPass(std::string_view name) {
  return m_log->begin(name, false);
}

void HostRecorder::endPass(int index) noexcept {
  m_log->end(index);
}

} // namespace volmark
