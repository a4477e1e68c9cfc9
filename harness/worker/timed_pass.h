// The timed pass: warm-up, headline and breakdown orbits. Nothing here counts, reads back or touches files
// while the clock runs.
#pragma once

#include "measure/clocks.h"
#include "results/records.h"
#include "worker/session.h"
#include "worker/trace.h"

#include <functional>

namespace volmark {

class TimedPass {
public:
  /// `tick` is called between frames, for progress; it must be cheap.
  TimedPass(Session& session, std::function<void()> tick);

  void warmUp();
  /// Pacing `frames`: orbit k of the headline or breakdown kind. Pacing `timed`: the whole timed part.
  void orbit(OrbitKind kind, int orbit);

  const std::vector<FrameRow>& rows() const { return m_rows; }
  const Trace& trace() const { return m_trace; }
  double firstFrameMs() const { return m_firstFrameMs; }

private:
  void drawAt(const std::vector<double>& phases, OrbitKind kind, int orbit);
  void drawByClock(double seconds, OrbitKind kind);
  void submit(double phase, OrbitKind kind);
  void collect(OrbitKind kind, int orbit);
  void startClock();

  Session& m_session;
  std::function<void()> m_tick;
  DisturbanceMonitor m_monitor;
  std::vector<FrameRow> m_rows;
  Trace m_trace;
  double m_firstFrameMs = 0;
  int m_frame = 0; ///< within the orbit, of the next frame to complete

  // At the previous completion.
  double m_lastEndMs = 0;
  double m_lastCpuMs = 0;
  DisturbanceCounters m_lastCounters;
};

} // namespace volmark
