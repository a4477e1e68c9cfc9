// Idle workers that wait for the next run of their volume (measure.isolation "volume").
#pragma once

#include "scenario/point.h"
#include "worker/worker_link.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace volmark {

/// Equal for points that open the same volume.
std::string volumeKeyOf(const Point& point);

class WorkerPool {
public:
  /// An idle worker of this program that has the volume open, else a new one. Idle ones of other volumes end: one
  /// volume is worked through after the other.
  std::unique_ptr<WorkerLink> take(const std::filesystem::path& program, const std::string& volume);

  /// After a run without any fault.
  void giveBack(std::unique_ptr<WorkerLink> link, const std::filesystem::path& program, const std::string& volume);

private:
  struct Idle {
    std::unique_ptr<WorkerLink> link;
    std::filesystem::path program;
    std::string volume;
  };
  std::vector<Idle> m_idle;
};

} // namespace volmark
