#include "worker/frame_slot.h"

#include "volmark/host_recorder.h"

namespace volmark {

namespace {

class GpuSlot : public FrameSlot {
public:
  explicit GpuSlot(gpu::Device& device) : m_commands(device), m_recorder(m_commands) {}

  Recorder& recorder() override { return m_recorder; }
  void begin(StampMode mode) override {
    m_recorder.setMode(mode);
    m_recorder.beginFrame();
  }
  void updateDone() override { m_recorder.markUpdateDone(); }
  void submit() override { m_recorder.endFrame(); }
  FrameTimes finish() override { return m_recorder.finish(); }

private:
  gpu::Commands m_commands;
  gpu::FrameRecorder m_recorder;
};

class HostSlot : public FrameSlot {
public:
  Recorder& recorder() override { return m_recorder; }
  void begin(StampMode) override { m_recorder.beginFrame(); }
  void updateDone() override { m_recorder.markUpdateDone(); }
  void submit() override { m_recorder.endFrame(); }
  FrameTimes finish() override { return m_recorder.finish(); }

private:
  HostRecorder m_recorder;
};

} // namespace

std::unique_ptr<FrameSlot> makeGpuSlot(gpu::Device& device) {
  return std::make_unique<GpuSlot>(device);
}

std::unique_ptr<FrameSlot> makeHostSlot() {
  return std::make_unique<HostSlot>();
}

} // namespace volmark
