// The recorder of GPU techniques: passes in a command buffer, timed by stamps.
#pragma once

#include "volmark/frame_times.h"
#include "volmark/gpu/commands.h"
#include "volmark/recorder.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace volmark {
class PassLog;
}

namespace volmark::gpu {

/// Order of calls: beginFrame, update, markUpdateDone, draw, endFrame, finish; generation: beginFrame, prepare,
/// endFrame, finish. For several frames in flight make one recorder, with its own Commands, per slot. Every stamp
/// stands between two full barriers: some drivers queue the work of draws beyond a bare timestamp.
class FrameRecorder : public Recorder {
public:
  explicit FrameRecorder(Commands& commands, StampMode mode = StampMode::headline);
  ~FrameRecorder() override;
  FrameRecorder(const FrameRecorder&) = delete;
  FrameRecorder& operator=(const FrameRecorder&) = delete;

  /// Between frames only.
  void setMode(StampMode mode) { m_mode = mode; }

  void beginFrame();
  void markUpdateDone();
  void endFrame();     ///< last stamp; submits
  FrameTimes finish(); ///< waits, reads the stamps

  Commands& gpu() override { return m_commands; }

protected:
  int beginGpuPass(std::string_view name) override;
  int beginHostPass(std::string_view name) override;
  void endPass(int index) noexcept override;

private:
  bool hasStamps() const { return m_pool != VK_NULL_HANDLE; }
  /// Index of the query, or -1 without timestamps.
  int stamp();
  double msBetween(int first, int last, const std::vector<std::uint64_t>& stamps) const;
  FrameTimes timesOf(const std::vector<std::uint64_t>& stamps) const;

  Commands& m_commands;
  StampMode m_mode;
  VkQueryPool m_pool = VK_NULL_HANDLE;
  std::uint64_t m_mask = 0;
  double m_periodNs = 0;
  std::unique_ptr<PassLog> m_log;
  int m_stampCount = 0;
  int m_updateStamp = -1;
};

} // namespace volmark::gpu
