// One frame in flight: recording and timing on the GPU or on the host behind one interface.
#pragma once

#include "volmark/frame_times.h"
#include "volmark/gpu/frame_recorder.h"
#include "volmark/recorder.h"

#include <memory>

namespace volmark {

class FrameSlot {
public:
  virtual ~FrameSlot() = default;
  virtual Recorder& recorder() = 0;
  virtual void begin(StampMode mode) = 0;
  virtual void updateDone() = 0; ///< between update() and draw()
  virtual void submit() = 0;
  virtual FrameTimes finish() = 0; ///< waits
};

std::unique_ptr<FrameSlot> makeGpuSlot(gpu::Device& device);
std::unique_ptr<FrameSlot> makeHostSlot();

} // namespace volmark
