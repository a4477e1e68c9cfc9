// One run in a worker process: its parts in the order of the turns, from opening the volume to committed results.
#pragma once

#include "results/records.h"
#include "technique/catalogue.h"
#include "worker/messages.h"
#include "worker/replay.h"
#include "worker/session.h"
#include "worker/timed_pass.h"
#include "worker/trace.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace volmark {

/// What a worker keeps from one run to the next.
class WorkerMemory {
public:
  /// Modules of these folders; of the program's own if there are none.
  const TechniqueCatalogue& catalogue(const std::vector<std::string>& folders);
  /// The point's volume, opened anew only if the last one was another. Throws InputError.
  std::shared_ptr<const Volume> volume(const Point& point, const DataFolders& data, std::uint64_t maximumBytes);

private:
  std::optional<TechniqueCatalogue> m_catalogue;
  std::vector<std::string> m_folders;
  std::shared_ptr<const Volume> m_volume;
  std::string m_volumeKey;
};

class WorkerRun {
public:
  /// Progress goes to `runner`. Throws InputError, like all that follows also UnsupportedError and DeviceError.
  WorkerRun(const WorkerStart& start, LineChannel& runner, WorkerMemory& kept);

  /// "prepare", "warm_up", "headline", "breakdown", "finish": in this order.
  void take(const std::string& turn, const TurnRow& place);

  const PointSettings& settings() const { return m_point.settings; }
  nlohmann::json provenanceNow();

private:
  void act(const std::string& turn, const TurnRow& place);
  void tick();
  void prepare();
  void headline(const TurnRow& place);
  void breakdown(TurnRow place);
  void testStamps();
  void keepTimedFrame();
  void finish();
  void checkReplays(Replay& replay, const std::vector<Picture>& first);
  void checkMemory();
  void checkValidation();

  WorkerStart m_start;
  LineChannel& m_runner;
  WorkerMemory& m_kept;
  Point m_point;
  const CatalogueEntry& m_entry;
  std::unique_ptr<Session> m_session;
  std::unique_ptr<TimedPass> m_timed;
  std::vector<Picture> m_timedFrame;
  std::optional<bool> m_stampsTrusted;
  Trace m_trace; ///< as of m_timedFrame: breakdown orbits are not part of it
  RunRecord m_record;
  int m_frames = 0;
  double m_lastTickMs = 0;
  double m_activeMs = 0;
  double m_turnBeginMs = 0;
};

} // namespace volmark
