// One technique on one scene, frame by frame: what worker processes and `volmark render` share.
#pragma once

#include "technique/catalogue.h"
#include "timeline/timeline.h"
#include "volmark/frame_times.h"
#include "volmark/gpu/device.h"
#include "volmark/gpu/target.h"
#include "worker/frame_slot.h"
#include "worker/waste.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace volmark {

struct SessionOptions {
  std::string device; ///< selector of gpu::DeviceOptions
  bool validate = false;
};

/// A frame that has finished.
struct CompletedFrame {
  double phase = 0;
  double startMs = 0; ///< CLOCK_MONOTONIC, before update
  double endMs = 0;   ///< when its completion was seen
  FrameTimes times;
};

class Session {
public:
  /// Makes the device (unless the technique needs none), the output and the technique. Throws
  /// UnsupportedError with the technique's own reason where it can't run.
  Session(const PointSettings& settings, const CatalogueEntry& technique, std::shared_ptr<const Volume> volume,
          const SessionOptions& options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Generation; its passes in order. Once, before anything else.
  FrameTimes prepare();
  /// History is empty; the next frame is told that everything changed.
  void reset();

  /// Starts one frame. At most framesInFlight() may be unfinished.
  void submit(double phase, std::uint64_t index, StampMode mode, bool counting = false);
  /// Waits for the oldest unfinished frame.
  CompletedFrame complete();
  CompletedFrame draw(double phase, std::uint64_t index, StampMode mode, bool counting = false) {
    submit(phase, index, mode, counting);
    return complete();
  }
  std::size_t unfinished() const { return m_unfinished.size(); }
  std::size_t framesInFlight() const { return m_slots.size(); }

  /// Colours and distances of the last finished frame, one picture per view.
  std::vector<Picture> pictures() const;
  /// Adds the layers that the technique declares to pictures of the same frame. The last finished one was counting.
  void addLayers(std::vector<Picture>& pictures) const;

  const TechniqueInfo& info() const { return m_entry.factory->info; }
  Technique& technique() { return *m_technique; }
  const Timeline& timeline() const { return m_timeline; }
  const Scene& scene() const { return m_scene; }
  const PointSettings& settings() const { return m_settings; }
  /// Null for techniques without a GPU.
  gpu::Device* device() const { return m_device.get(); }
  /// Destroys the technique and all that frames were drawn with; returns the bytes of device memory that are still
  /// in the ledger: 0, or somebody's leak. Nothing but device() may be called afterwards.
  std::uint64_t close();
  /// What the ledger holds beyond the harness's own output: the technique's device memory. 0 without a GPU.
  std::uint64_t techniqueBytes() const;

private:
  struct Unfinished {
    std::size_t slot;
    double phase;
    double startMs;
    double startCpuMs;
  };

  const PointSettings m_settings;
  const CatalogueEntry& m_entry;
  Scene m_scene;
  Timeline m_timeline;
  std::unique_ptr<gpu::Device> m_device;
  std::unique_ptr<gpu::Target> m_target;
  std::vector<Picture> m_pictures; ///< output of host techniques
  std::vector<std::unique_ptr<FrameSlot>> m_slots;
  std::unique_ptr<Technique> m_technique; ///< after what it refers to
  std::deque<Unfinished> m_unfinished;
  std::size_t m_nextSlot = 0;
  std::optional<double> m_previousPhase;
  std::uint64_t m_outputBytes = 0;
  Waste m_waste;
};

} // namespace volmark
