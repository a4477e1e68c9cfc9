// The runner's side of one worker process.
#pragma once

#include "worker/messages.h"

#include <filesystem>
#include <memory>
#include <string>
#include <sys/types.h>

namespace volmark {

class WorkerLink {
public:
  /// Starts this program again as a worker; its output goes to `log`. The child dies with this process.
  /// Throws DeviceError when no process can be made.
  WorkerLink(const WorkerStart& start, const std::filesystem::path& log);
  /// Kills the child if it still lives.
  ~WorkerLink();
  WorkerLink(const WorkerLink&) = delete;
  WorkerLink& operator=(const WorkerLink&) = delete;

  void grant(const std::string& turn, int orbit = 0);

  struct Answer {
    enum class Kind { done, frames, failed, died, nothing } kind = Kind::nothing;
    nlohmann::json message; ///< of failed
    std::string reason;     ///< of died: "signal 11 (Segmentation fault)" or "exit code 3"
  };
  /// Waits at most `timeoutMs`.
  Answer wait(int timeoutMs);

  void kill();

private:
  std::string reap();

  pid_t m_pid = -1;
  int m_toChild = -1;
  int m_fromChild = -1;
  std::unique_ptr<LineChannel> m_channel;
};

} // namespace volmark
