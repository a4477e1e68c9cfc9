// results/<experiment>/: where runs are found, claimed, written and counted.
#pragma once

#include "results/records.h"
#include "scenario/scenario.h"

#include <filesystem>
#include <memory>
#include <string>

namespace volmark {

/// What names a run: see harness/README.md, Results.
struct RunIdentity {
  std::string point;        ///< hash
  std::string run;          ///< hash of point, build, device and replicate
  int replicate = 0;
};

/// 32 hex digits (XXH3-128) of the canonical point configuration and the volume's identity.
std::string pointHash(const nlohmann::json& config, const std::string& volumeIdentity);
std::string runHash(const std::string& point, const std::string& build, const std::string& device, int replicate);

/// Exclusive right to write one run. Released (file removed) on destruction.
class Claim {
public:
  ~Claim();
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;
  void beat();              ///< refreshes the heartbeat; call at least every 10 s

private:
  friend class Experiment;
  explicit Claim(std::filesystem::path file) : m_file(std::move(file)) {}
  std::filesystem::path m_file;
};

class Experiment {
public:
  /// Creates or reopens results/<name>/ and writes experiment.json. Throws InputError when the folder can't
  /// be written or belongs to a format version or scenario name that doesn't fit; leaves nothing half-made.
  Experiment(const std::filesystem::path& resultsFolder, const Scenario& scenario);

  const std::filesystem::path& folder() const { return m_folder; }
  std::filesystem::path runFolder(const RunIdentity& identity) const;      ///< runs/<2 hex>/<hash>

  /// run.json is there and readable: its status. Absent: not done.
  std::optional<std::string> statusOf(const RunIdentity& identity) const;

  /// Nothing if another live process has the run (a claim whose heartbeat is older than 60 s, or whose pid on
  /// this host is gone, is taken over).
  std::unique_ptr<Claim> claim(const RunIdentity& identity) const;

  /// An empty staging folder for a run's files; leftovers of an earlier attempt are removed.
  std::filesystem::path stage(const RunIdentity& identity) const;

  /// Writes frames.csv, counters.csv, pictures.csv and run.json into the staging folder, then makes it the
  /// run's folder: run.json appears last, by atomic rename.
  void commit(const RunIdentity& identity, const Point& point, const CatalogueEntry& technique,
              const RunRecord& record) const;

  /// Rebuilds index.csv and google_benchmark.json from the runs that are there.
  void writeIndex() const;

private:
  std::filesystem::path m_folder;
};

} // namespace volmark
