// The recorder of techniques that need no GPU.
#pragma once

#include "volmark/frame_times.h"
#include "volmark/recorder.h"

#include <memory>

namespace volmark {

class PassLog;

/// Order of calls: beginFrame, update, markUpdateDone, draw, endFrame, finish. Generation: beginFrame, prepare,
/// endFrame, finish (its time counts as draw).
class HostRecorder : public Recorder {
public:
  HostRecorder();
  ~HostRecorder() override;

  void beginFrame();
  void markUpdateDone();
  void endFrame();
  /// updateHostMs and drawHostMs are wall time between the marks, whether in a pass or not.
  FrameTimes finish();

  /// Throws std::logic_error: a technique with needsGpu = false has no command buffer.
  gpu::Commands& gpu() override;

protected:
  int beginGpuPass(std::string_view name) override;
  int beginHostPass(std::string_view name) override;
  void endPass(int index) noexcept override;

private:
  std::unique_ptr<PassLog> m_log;
  double m_begin = 0;
  double m_updateDone = 0;
  double m_end = 0;
};

} // namespace volmark
