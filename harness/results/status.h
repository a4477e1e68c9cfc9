// How far an experiment is, from its files alone.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace volmark {

/// A process that holds claims.
struct ActiveProcess {
  std::string host;
  int pid = 0;
  int runs = 0;
  double heartbeatSeconds = 0; ///< age of its newest heartbeat, by this machine's clock
};

/// Counts runs: points times replicates as experiment.json lists them. Of the runs of one point and replicate on
/// several builds or devices the one that started last counts.
struct ExperimentStatus {
  std::string name;
  int planned = 0;
  int completed = 0;
  int failed = 0; ///< failed, crashed, timed out or out of memory
  int unsupported = 0;
  int running = 0;                   ///< claimed by a process that lives or, on another host, beats
  int left = 0;                      ///< neither done nor running
  std::optional<double> secondsLeft; ///< of all that isn't done, for the processes that are active now, at least one
  std::vector<int> leftPoints;       ///< with runs that aren't done, running or not; sorted
  std::vector<ActiveProcess> active;
  int builds = 0; ///< distinct programs and devices among the runs that count
};

/// Throws InputError if there is no experiment of this format version.
ExperimentStatus readStatus(const std::filesystem::path& experiment);

/// {"format": "volmark.status", "version": 1, ...}.
nlohmann::ordered_json statusDocument(const ExperimentStatus& status);

} // namespace volmark
