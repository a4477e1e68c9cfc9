// results/<experiment>/: where runs are found, claimed, written and counted.
#pragma once

#include "results/claim.h"
#include "results/hash.h"
#include "results/records.h"
#include "scenario/scenario.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace volmark {

class Experiment {
public:
  /// Creates or reopens results/<name>/ and writes experiment.json. The scenario of an existing experiment may
  /// have changed (grids grow). Throws InputError when the folder can't be written or holds another format
  /// version or another experiment; leaves nothing half-made.
  Experiment(const std::filesystem::path& resultsFolder, const Scenario& scenario);
  /// For workers: the folder of an experiment that the runner has opened; commits, but writes no index.
  explicit Experiment(std::filesystem::path folder, std::vector<std::string> axes = {})
      : m_folder(std::move(folder)), m_axes(std::move(axes)) {}

  const std::filesystem::path& folder() const { return m_folder; }
  std::filesystem::path runFolder(const RunIdentity& identity) const; ///< runs/<2 hex>/<hash>

  /// run.json is there and readable: its status. Absent: not done. Throws InputError for another format version.
  std::optional<std::string> statusOf(const RunIdentity& identity) const;

  /// Nothing if another live process has the run (see Claim). Throws DeviceError if it can't be written.
  std::unique_ptr<Claim> claim(const RunIdentity& identity) const;

  /// Claims of other machines that claim() met and that may yet turn out to be abandoned.
  bool watchesClaims() const { return m_watch.isUndecided(); }

  /// Removes a claim that a dead process left beside a run that is done.
  void releaseStaleClaim(const RunIdentity& identity) const;

  /// An empty staging folder for a run's files, runs/<2 hex>/.<run>.<pid>; leftovers of earlier attempts are
  /// removed. Only whoever has the claim may call this. Throws DeviceError.
  std::filesystem::path stage(const RunIdentity& identity) const;

  /// Removes what an interrupted run has staged. Only whoever has the claim may call this.
  void discard(const RunIdentity& identity) const;

  /// Writes frames.csv, counters.csv, pictures.csv and run.json into the staging folder, waits until all its
  /// files are on disk, then makes it the run's folder by one rename, in place of an earlier attempt. Uses the
  /// staging folder of this process or, if it has none, one that a dead worker left (its log.txt stays). A run
  /// that isn't completed keeps no pictures. Throws DeviceError (disk full...) and leaves no staging folder then.
  void commit(const RunIdentity& identity, const Point& point, const CatalogueEntry& technique,
              const RunRecord& record) const;

  /// Rebuilds index.csv and google_benchmark.json from the runs that are there. Throws DeviceError, and
  /// InputError for a run of another format version.
  void writeIndex() const;

private:
  std::filesystem::path m_folder;
  std::vector<std::string> m_axes;
  mutable ClaimWatch m_watch; ///< remembers what it saw, so that an abandoned claim is known when it is seen again
};

/// An experiment that is there, with the axes of its experiment.json.
Experiment reopenExperiment(const std::filesystem::path& folder);

} // namespace volmark
