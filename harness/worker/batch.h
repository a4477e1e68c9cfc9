// Runs that are interleaved: one live worker each, one of them active at a time.
#pragma once

#include "results/experiment.h"
#include "worker/build.h"
#include "worker/progress.h"
#include "worker/runner.h"
#include "worker/worker_link.h"
#include "worker/worker_pool.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace volmark {

/// A run that is to be done now.
struct PendingRun {
  const Point* point;
  const Build* build;
  CatalogueEntry technique; ///< with the digest of the build's own module
  RunIdentity identity;
};

class Batch {
public:
  /// Takes the runs whose claims it gets and which nobody has done since they were planned: `isDone` is asked again
  /// under the claim.
  Batch(const Experiment& experiment, const RunnerOptions& options, WorkerPool& pool,
        const std::function<bool(const RunIdentity&)>& isDone, std::vector<PendingRun> runs);
  ~Batch();

  /// Prepare, warm up, headline orbits in shuffled turns, breakdown orbits, finish. Stops early when
  /// interruptRequested is set: unfinished runs leave nothing. `advance` gets a share in [0,1] and a text.
  void work(const std::function<void(double, const std::string&)>& advance);

  int doneMeanwhile() const { return m_doneMeanwhile; }
  /// Runs that other processes have claimed.
  const std::vector<PendingRun>& elsewhere() const { return m_elsewhere; }
  /// Runs that memory was too short for beside the others: they are to be worked alone, after this batch.
  const std::vector<PendingRun>& deferred() const { return m_deferred; }
  /// Status of each run of the batch that ended, in the order given.
  struct Ended {
    const PendingRun* run;
    std::string status;
    std::string reason;
  };
  const std::vector<Ended>& ended() const { return m_ended; }

private:
  struct Member;

  bool hasRoomForAnother();
  void begin(Member& member);
  void everyoneTakes(const std::string& turn, int orbit, bool shuffled);
  bool take(Member& member, const std::string& turn, const TurnRow& place = {});
  void end(Member& member, RunStatus status, const std::string& reason, const nlohmann::json& provenance);
  /// Interrupted: kills the worker and leaves nothing of its run.
  void abandon(Member& member);
  std::vector<Member*> living();

  const Experiment& m_experiment;
  const RunnerOptions& m_options;
  WorkerPool& m_pool;
  std::vector<std::unique_ptr<Member>> m_members;
  std::vector<Ended> m_ended;
  std::function<void(double, const std::string&)> m_advance;
  std::uint64_t m_shuffles = 0;
  double m_turnsTaken = 0;
  double m_turnsPlanned = 1;
  int m_doneMeanwhile = 0;
  std::vector<PendingRun> m_elsewhere;
  std::vector<PendingRun> m_deferred;
};

} // namespace volmark
