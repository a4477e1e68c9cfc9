// One process at a time works on a run.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <sys/types.h>

namespace volmark {

/// A claim of another machine that shows no heartbeat for so long, while it is watched, is abandoned.
inline constexpr std::chrono::milliseconds kClaimLifetime{60000};

/// Watches heartbeats by this process's own steady clock: what other machines write as time, and clocks that are set
/// while a grid runs, don't matter.
class ClaimWatch {
public:
  explicit ClaimWatch(std::chrono::milliseconds lifetime = kClaimLifetime) : m_lifetime(lifetime) {}

  /// `state`: anything that changes with a heartbeat. True once it has stayed the same for the lifetime.
  bool isAbandoned(const std::filesystem::path& file, const std::string& state);
  void forget(const std::filesystem::path& file) { m_seen.erase(file); }
  /// Some claim was seen, but no heartbeat since, and its lifetime isn't over.
  bool isUndecided() const;

private:
  using Clock = std::chrono::steady_clock;
  struct Seen {
    std::string state;
    Clock::time_point since;
    bool beats = false;
  };
  std::chrono::milliseconds m_lifetime;
  std::map<std::filesystem::path, Seen> m_seen;
};

/// Exclusive right to write one run: a file {"format": "volmark.claim", "version": 1, "host", "pid_namespace", "pid",
/// "process_started", "started"} whose modification time is the heartbeat. Released (file removed) on destruction,
/// unless somebody took it over or the process is a fork of the one that claimed.
class Claim {
public:
  ~Claim();
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;

  /// Refreshes the heartbeat; call at least every 10 s. False if the claim was lost: another machine, which saw
  /// no heartbeat for kClaimLifetime, works on the run now.
  bool beat();

  /// Claims the run of this file, whose folder must exist. Nothing if a living process has it. A claim is taken over
  /// if its process on this host is gone, or if `watch` knows it as abandoned. Throws DeviceError.
  static std::unique_ptr<Claim> take(const std::filesystem::path& file, ClaimWatch& watch);

private:
  Claim(std::filesystem::path file, std::string text);
  bool isMine(int openFile) const;

  std::filesystem::path m_file;
  std::string m_text; ///< what this process wrote
  pid_t m_owner;
};

/// What a claim says, for people.
struct ClaimFacts {
  std::string host; ///< "" if it can't be read
  int pid = 0;
  double heartbeatSeconds = 0; ///< its age by this machine's clock
  /// Its process lives on this host or, as far as the clocks agree, beat within kClaimLifetime elsewhere.
  bool active = false;
};
ClaimFacts readClaim(const std::filesystem::path& file);

} // namespace volmark
