// After the clock has stopped: the counting pass and the picture pass replay the trace, and the pictures are
// judged against the reference.
#pragma once

#include "results/records.h"
#include "worker/reference_cache.h"
#include "worker/session.h"
#include "worker/trace.h"

#include <filesystem>
#include <functional>
#include <map>
#include <vector>

namespace volmark {

class Replay {
public:
  Replay(Session& session, const Trace& trace, std::function<void()> tick);

  /// Draws the trace again after reset and calls `seen` after each frame of `wanted` (indices into the trace,
  /// ascending). Techniques without history draw only the wanted frames; the others everything before them.
  void run(const std::vector<std::size_t>& wanted, bool counting, const std::function<void(std::size_t)>& seen);

  /// Counters of every frame of the last timed orbit. Adds the technique's layers to those of the `captured` frames.
  std::vector<CounterRow> count(std::map<std::size_t, std::vector<Picture>>& captured);

  /// Frames of the trace to capture: `count` of the last timed orbit, evenly spread, and its last frame.
  std::vector<std::size_t> capturedFrames(int count) const;

  /// One picture per view of each wanted frame.
  std::map<std::size_t, std::vector<Picture>> draw(const std::vector<std::size_t>& wanted);

private:
  Session& m_session;
  const Trace& m_trace;
  std::function<void()> m_tick;
};

/// The timed frame is the frame that is shown: `timed` against a replay of the same frame, bit by bit, or
/// within the spread of replays for techniques that are not deterministic.
RunCheck compareTimedWithReplay(const std::vector<Picture>& timed, const std::vector<std::vector<Picture>>& replays,
                                bool deterministic);

/// Lossless history must not show: a frame drawn after a full replay against the same frame on fresh state.
RunCheck compareWithFreshState(Session& session, const Trace& trace, std::size_t frame,
                               const std::vector<Picture>& replayed);

/// Where captured pictures go and what they are judged against.
struct Judgement {
  const Session& session;
  const Trace& trace;
  std::filesystem::path runFolder; ///< EXR files are written here
  std::filesystem::path experimentFolder;
  std::string run; ///< hash, for the EXR attribute
};

/// Writes each captured frame as EXR and compares it with the reference named in the point. `rows` are the
/// timed frames, for the cumulative time.
std::vector<PictureRow> judgePictures(const Judgement& judgement,
                                      const std::map<std::size_t, std::vector<Picture>>& captured,
                                      const std::vector<FrameRow>& rows);

} // namespace volmark
