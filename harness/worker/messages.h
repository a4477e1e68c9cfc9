// JSON lines between the runner and a worker process, over two pipes.
//
// runner to worker   {"describe": 1}                     what the program is; nothing else before it or after
//                    {"start": {...}}                    a run begins; after a finished one another may. See
//                    WorkerStart
//                    {"turn": "prepare"|"warm_up"|"headline"|"breakdown"|"finish", "orbit": k, "place": i, "of": n}
// worker to runner   {"described": {"protocol": 1, "commit", "techniques": {name: {"module_digest", "build_digest"}}}}
//                    {"done": "<turn>"}                  the turn is over, the worker waits
//                    {"frames": n}                       still drawing; at most twice a second
//                    {"failed": "<status>", "reason": "<one line>", "provenance": {...}}   the worker ends
// When the runner closes its end, the worker ends.
#pragma once

#include <nlohmann/json.hpp>

#include <optional>
#include <string>

namespace volmark {

/// Runners and workers of different builds understand each other if this is equal.
inline constexpr int kWorkerProtocol = 1;

/// Everything a worker needs to know.
struct WorkerStart {
  nlohmann::json config;                     ///< resolved point: what is written
  nlohmann::json settings;                   ///< the same without defaults: what is read
  std::vector<std::string> techniqueFolders; ///< empty: the worker's own
  std::string scenesFolder;
  std::vector<std::string> dataFolders;
  std::string device; ///< selector
  bool validate = false;
  std::uint64_t maximumBytes = 0; ///< of a volume
  std::string stagingFolder;
  std::string experimentFolder;
  std::string pointHash;
  std::string runHash;
  int replicate = 0;
  int pointIndex = 0;
  std::string group;
  std::vector<std::pair<std::string, std::string>> labels; ///< axis, value
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(WorkerStart, config, settings, techniqueFolders, scenesFolder, dataFolders, device,
                                   validate, maximumBytes, stagingFolder, experimentFolder, pointHash, runHash,
                                   replicate, pointIndex, group, labels)

/// Reads and writes lines on file descriptors. Not thread-safe.
class LineChannel {
public:
  LineChannel(int readFd, int writeFd) : m_read(readFd), m_write(writeFd) {}

  /// False if the other side is gone.
  bool send(const nlohmann::json& message);

  enum class Result { message, timeout, closed };
  /// Waits at most `timeoutMs` (negative: for ever). A signal counts as timeout.
  Result receive(nlohmann::json& message, int timeoutMs);

private:
  int m_read;
  int m_write;
  std::string m_buffer;
};

} // namespace volmark
