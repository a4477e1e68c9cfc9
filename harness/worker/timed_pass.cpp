#include "worker/timed_pass.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace volmark {

TimedPass::TimedPass(Session& session, std::function<void()> tick) : m_session(session), m_tick(std::move(tick)) {
}

void TimedPass::startClock() {
  m_frame = 0;
  m_lastEndMs = std::numeric_limits<double>::quiet_NaN();
  m_lastCpuMs = processCpuMs();
  m_lastCounters = m_monitor.read();
}

void TimedPass::warmUp() {
  const PacingSettings& pacing = m_session.settings().pacing;
  m_session.reset();
  startClock();
  if (pacing.mode == PacingSettings::Mode::timed) {
    drawByClock(pacing.warmUpSeconds, OrbitKind::warmUp);
  } else {
    // The end of an orbit, so that the first timed frame continues the motion.
    std::vector<double> phases;
    const int count = std::max(3, pacing.warmUpFrames);
    for (int i = 0; i < count; ++i) {
      const int frame = (pacing.frames - count % pacing.frames + i) % pacing.frames;
      phases.push_back(m_session.timeline().phaseOf(frame, pacing.frames));
    }
    drawAt(phases, OrbitKind::warmUp, 0);
  }
  m_firstFrameMs = m_rows.front().hostMs;
}

void TimedPass::orbit(OrbitKind kind, int orbit) {
  const PacingSettings& pacing = m_session.settings().pacing;
  if (kind == OrbitKind::headline) m_trace.lastOrbitBegin = m_trace.phases.size();
  startClock();
  if (pacing.mode == PacingSettings::Mode::timed && kind == OrbitKind::headline) {
    drawByClock(pacing.seconds, kind);
    return;
  }
  std::vector<double> phases;
  for (int i = 0; i < pacing.frames; ++i)
    phases.push_back(m_session.timeline().phaseOf(i, pacing.frames));
  drawAt(phases, kind, orbit);
}

void TimedPass::drawAt(const std::vector<double>& phases, OrbitKind kind, int orbit) {
  for (const double phase : phases) {
    if (m_session.unfinished() == m_session.framesInFlight()) collect(kind, orbit);
    submit(phase, kind);
  }
  while (m_session.unfinished() > 0)
    collect(kind, orbit);
}

void TimedPass::drawByClock(double seconds, OrbitKind kind) {
  const double beginMs = monotonicMs();
  int drawn = 0;
  for (;;) {
    const double phase = (monotonicMs() - beginMs) / (1000 * seconds);
    if (phase >= 1 && drawn >= 3) break;
    if (m_session.unfinished() == m_session.framesInFlight()) collect(kind, 0);
    submit(std::min(phase, 1.0), kind);
    ++drawn;
  }
  while (m_session.unfinished() > 0)
    collect(kind, 0);
}

void TimedPass::submit(double phase, OrbitKind kind) {
  const StampMode mode = kind == OrbitKind::breakdown ? StampMode::breakdown : StampMode::headline;
  m_session.submit(phase, m_trace.phases.size(), mode);
  m_trace.phases.push_back(phase);
}

void TimedPass::collect(OrbitKind kind, int orbit) {
  const CompletedFrame frame = m_session.complete();
  const double cpuMs = processCpuMs();
  const DisturbanceCounters counters = m_monitor.read();

  FrameRow row;
  row.orbitKind = kind;
  row.orbit = orbit;
  row.frame = m_frame++;
  row.phase = frame.phase;
  row.hostMs = frame.endMs - frame.startMs;
  row.intervalMs = frame.endMs - m_lastEndMs;
  row.cpuMs = cpuMs - m_lastCpuMs;
  row.updateMs = frame.times.updateMs();
  row.drawMs = frame.times.drawMs();
  row.frameMs = row.updateMs + row.drawMs;
  row.gpuMs = frame.times.gpuMs;
  row.disturbed = disturbanceBetween(m_lastCounters, counters, row.hostMs);
  if (kind == OrbitKind::breakdown)
    for (const auto& pass : frame.times.passes)
      row.passes.push_back({pass.name, pass.ms});
  m_rows.push_back(std::move(row));

  m_tick();
  m_lastEndMs = frame.endMs;
  m_lastCpuMs = cpuMs;
  m_lastCounters = counters;
}

} // namespace volmark
