#include "test_techniques.h"
#include "volmark/error.h"
#include "volmark/gpu/device.h"

#include <chrono>
#include <csignal>
#include <cstring>
#include <new>
#include <sys/mman.h>
#include <thread>

namespace volmark::test {

namespace {

/// Behaves until frame `at`, then does what `fault` says. Without a fault it fills the picture with the frame's
/// isovalue. Draws on the host.
class Faults : public Technique {
public:
  void prepare(const Preparation& preparation, Recorder& recorder) override {
    const auto pass = recorder.hostPass("nothing");
    m_fault = preparation.parameters.text("fault");
    m_at = static_cast<std::uint64_t>(preparation.parameters.integer("at"));
    m_frameMs = preparation.parameters.number("frame_ms");
    if (m_fault == "unsupported") throw UnsupportedError("this fault is about being unsupported");
  }

  void reset(std::uint64_t) override { ++m_resets; }
  void update(const Changes&, const FrameInputs&, Recorder&) override {}

  void draw(const Frame& frame, Recorder& recorder) override {
    const auto pass = recorder.hostPass("fill");
    if (frame.index >= m_at) misbehave();
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(m_frameMs));
    // A liar shows how often it was reset: its replay can't equal the timed frame.
    const float value = m_fault == "lie" ? static_cast<float>(m_resets) : static_cast<float>(frame.inputs.isovalue);
    for (Picture& picture : *frame.pictures)
      std::fill(picture.color.begin(), picture.color.end(), glm::vec4(value, value, value, 1));
  }

  std::vector<gpu::MemoryItem> memory() const override { return {}; }

private:
  static constexpr std::size_t kChunk = 64 << 20;

  /// Memory that no limit of the process sees.
  static void* sharedChunk() {
    void* memory = mmap(nullptr, kChunk, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    return memory;
  }

  void misbehave() const {
    if (m_fault == "crash") std::raise(SIGSEGV);
    if (m_fault == "kill") std::raise(SIGKILL);
    if (m_fault == "throw") throw std::runtime_error("this technique throws");
    if (m_fault == "memory") throw std::bad_alloc();
    if (m_fault == "device_lost") gpu::check(VK_ERROR_DEVICE_LOST, "vkQueueSubmit2");
    // A little in every frame, so that limits are met on the way.
    if (m_fault == "allocate") std::memset(new char[kChunk], 1, kChunk);
    if (m_fault == "share") std::memset(sharedChunk(), 1, kChunk);
    while (m_fault == "hang")
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }

  std::string m_fault;
  std::uint64_t m_at = 0;
  double m_frameMs = 0;
  int m_resets = 0;
};

} // namespace

TechniqueFactory faultsFactory() {
  TechniqueInfo info;
  info.name = "test_faults";
  info.summary = "Misbehaves on request";
  info.draws = Draws::both;
  info.needsGpu = false;
  info.shadings = {ShadingModel::none};
  info.parameters = {ParameterDescriptor::choice("fault", "none",
                                                 {"none", "crash", "kill", "throw", "memory", "allocate", "share",
                                                  "device_lost", "hang", "unsupported", "lie"},
                                                 "What goes wrong"),
                     ParameterDescriptor::integer("at", 4, 0, 1000000, "frame", "When it goes wrong"),
                     ParameterDescriptor::number("frame_ms", 0.2, 0, 1000, "ms", "How long a frame sleeps")};
  info.passes = {{"fill", "fills the picture"}};
  info.generation = {{"nothing", "does nothing"}};
  return {info, []() -> std::unique_ptr<Technique> { return std::make_unique<Faults>(); }};
}

} // namespace volmark::test
