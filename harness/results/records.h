// What is known of a run when it ends; the C++ side of results/<experiment>/runs/ (harness/README.md, Results).
#pragma once

#include "image/metrics.h"
#include "measure/statistics.h"
#include "volmark/technique.h"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace volmark {

struct PassTime {
  std::string name;
  double ms = 0;
};

enum class OrbitKind { warmUp, headline, breakdown };

/// One frame as timed. Absent times are NaN and empty fields in the CSV.
struct FrameRow {
  OrbitKind orbitKind = OrbitKind::headline;
  int orbit = 0;
  int frame = 0;         ///< within the orbit
  double phase = 0;      ///< place on the timeline, [0,1]
  double hostMs = 0;     ///< host clock: start of update to completion
  double intervalMs = 0; ///< between completions
  double cpuMs = 0;      ///< process CPU
  double updateMs = 0;
  double drawMs = 0;
  double frameMs = 0;           ///< updateMs + drawMs
  double gpuMs = 0;             ///< first stamp to last; NaN without a GPU
  std::string disturbed;        ///< empty, or why
  std::vector<PassTime> passes; ///< breakdown orbits only
};

struct CounterRow {
  int frame = 0;
  double phase = 0;
  std::vector<CounterValue> values;
};

struct PictureRow {
  int frame = 0; ///< of the orbit
  double phase = 0;
  int view = 0;
  std::string file;          ///< relative to the run's folder
  std::string reference;     ///< "cpu" or "none"
  std::string referenceFile; ///< relative to the experiment's folder; empty without reference
  PictureErrors errors;
  double cumulativeMs = 0; ///< visible history: sum of frame_ms since reset() up to this frame
};

struct GenerationPass {
  std::string name;
  double hostMs = 0;
  double gpuMs = 0; ///< NaN for host passes
};

/// Result of a check that the harness makes on every run.
struct RunCheck {
  std::string name; ///< "timed_frame_equals_replay", "memory_equals_ledger", "stamps_ratio"
  bool passed = true;
  std::string detail;
};

/// A turn of an orbit among interleaved runs: the `place`th of `of` to draw it.
struct TurnRow {
  OrbitKind orbitKind = OrbitKind::headline;
  int orbit = 0;
  int place = 0;
  int of = 1;
};

enum class RunStatus { completed, failed, crashed, timedOut, unsupported, outOfMemory };
RunStatus runStatusFromName(const std::string& name); ///< the inverse; `failed` for any other text
std::string nameOf(RunStatus status); ///< "completed", "failed", "crashed", "timed_out", "unsupported", "out_of_memory"

/// All that a worker hands to the writer.
struct RunRecord {
  RunStatus status = RunStatus::completed;
  std::string reason; ///< one line unless completed
  std::vector<FrameRow> frames;
  std::vector<CounterRow> counters;
  std::vector<PictureRow> pictures;
  std::vector<GenerationPass> generation;
  std::vector<TurnRow> turns; ///< of headline and breakdown orbits, in the order in which they were taken
  double activeSeconds = 0;   ///< wall time of all turns: what the time limit and the hours left are about
  double prepareMs = 0;
  double firstFrameMs = 0;
  std::vector<gpu::MemoryItem> memory;
  std::uint64_t ledgerBytes = 0;
  std::uint64_t ledgerPeakBytes = 0;
  std::vector<RunCheck> checks;
  nlohmann::json provenance; ///< results/provenance.h
};

} // namespace volmark
