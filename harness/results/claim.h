// One process at a time works on a run.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <sys/types.h>

namespace volmark {

/// A claim whose heartbeat is older than this is abandoned.
inline constexpr double kClaimLifetimeSeconds = 60;

/// Exclusive right to write one run: a file {"format": "volmark.claim", "version": 1, "host", "pid", "started"}
/// whose modification time is the heartbeat. Released (file removed) on destruction, unless somebody took it
/// over or the process is a fork of the one that claimed.
class Claim {
public:
  ~Claim();
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;

  /// Refreshes the heartbeat; call at least every 10 s. False if the claim was lost: another process, which saw
  /// no heartbeat for kClaimLifetimeSeconds, works on the run now.
  bool beat();

  /// Claims the run of this file, whose folder must exist. Nothing if a living process has it. A claim whose
  /// heartbeat is too old, or whose pid on this host is gone, is taken over. Throws DeviceError.
  static std::unique_ptr<Claim> take(const std::filesystem::path& file);

private:
  Claim(std::filesystem::path file, std::string text);
  bool isMine(int openFile) const;

  std::filesystem::path m_file;
  std::string m_text; ///< what this process wrote
  pid_t m_owner;
};

} // namespace volmark
