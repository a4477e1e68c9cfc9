// The grid: every point and replicate of a scenario, in worker processes that take turns.
#pragma once

#include "results/experiment.h"
#include "scenario/scenario.h"
#include "worker/build.h"
#include "worker/progress.h"

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace volmark {

struct RunnerOptions {
  std::filesystem::path resultsFolder;
  std::filesystem::path scenesFolder;
  std::vector<std::filesystem::path> techniqueFolders;
  DataFolders data;
  std::string device; ///< selector
  bool validate = false;
  bool retryFailed = false;       ///< run again what ended otherwise than completed
  std::uint64_t maximumBytes = 0; ///< of one volume
  /// Numbers in the scenario's expansion, sorted: run these alone. The experiment still lists all.
  std::optional<std::vector<int>> points;
  /// Every point is run by each of them, interleaved, under the label `build`; empty: by this program.
  std::vector<BuildChoice> builds;
  bool writeIndex = true;
  /// What interleaved workers may use together; nothing: what the machine has available.
  std::optional<std::uint64_t> workerBytes;
};

struct RunnerResult {
  int completed = 0;
  int alreadyDone = 0;
  int elsewhere = 0; ///< claimed by another process
  int failed = 0;    ///< failed, crashed, timed out or out of memory
  int unsupported = 0;
  bool interrupted = false;
  std::filesystem::path folder;
};

/// Set by the signal handler of SIGINT and SIGTERM.
extern std::atomic<bool> interruptRequested;

/// Opens every volume once (bad data stops here, before anything is written), then runs what is not done yet.
/// Throws InputError and DeviceError.
RunnerResult runScenario(Scenario scenario, const TechniqueCatalogue& catalogue, const RunnerOptions& options,
                         Progress& progress);

} // namespace volmark
