// The runner's side of one worker process.
#pragma once

#include "results/records.h"
#include "worker/messages.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <sys/types.h>

namespace volmark {

class WorkerLink {
public:
  /// Starts a program of volmark as a worker. Its output goes where this process's goes until a run begins, and
  /// then to the run's log. The child dies with this process. Throws DeviceError when no process can be made.
  explicit WorkerLink(const std::filesystem::path& program);
  /// Ends the child: one that waits for its next run ends by itself, others are killed.
  ~WorkerLink();
  WorkerLink(const WorkerLink&) = delete;
  WorkerLink& operator=(const WorkerLink&) = delete;

  /// {"described": ...} follows.
  void describe();
  void start(const WorkerStart& start);
  void grant(const std::string& turn, const TurnRow& place);

  struct Answer {
    enum class Kind { described, done, frames, failed, died, nothing } kind = Kind::nothing;
    nlohmann::json message; ///< of described and failed
    std::string reason;     ///< of died: "signal 11 (Segmentation fault)" or "exit code 3"
  };
  /// Waits at most `timeoutMs`.
  Answer wait(int timeoutMs);

  void kill();

  /// Memory that the child shares with nobody; 0 if it is gone.
  std::uint64_t privateBytes() const;

private:
  bool endsByItself();
  std::string reap();

  pid_t m_pid = -1;
  int m_toChild = -1;
  int m_fromChild = -1;
  std::unique_ptr<LineChannel> m_channel;
  bool m_idle = true; ///< between runs
};

} // namespace volmark
