#include "worker/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace volmark {

namespace {

/// Largest difference of any colour channel or distance; infinite where one has a surface and the other not.
double largestDifference(const std::vector<Picture>& a, const std::vector<Picture>& b) {
  double largest = 0;
  for (std::size_t view = 0; view < a.size(); ++view) {
    for (std::size_t i = 0; i < a[view].color.size(); ++i) {
      const glm::vec4 difference = glm::abs(a[view].color[i] - b[view].color[i]);
      largest = std::max<double>(largest, std::max({difference.x, difference.y, difference.z, difference.w}));
    }
    for (std::size_t i = 0; i < a[view].distance.size(); ++i) {
      const float x = a[view].distance[i];
      const float y = b[view].distance[i];
      if (x != y) largest = std::max<double>(largest, std::abs(x - y));
    }
  }
  return largest;
}

bool equalBits(const std::vector<Picture>& a, const std::vector<Picture>& b) {
  for (std::size_t view = 0; view < a.size(); ++view) {
    const Picture& x = a[view];
    const Picture& y = b[view];
    if (std::memcmp(x.color.data(), y.color.data(), x.color.size() * sizeof(glm::vec4)) != 0) return false;
    if (std::memcmp(x.distance.data(), y.distance.data(), x.distance.size() * sizeof(float)) != 0) return false;
  }
  return true;
}

} // namespace

Replay::Replay(Session& session, const Trace& trace, std::function<void()> tick)
    : m_session(session), m_trace(trace), m_tick(std::move(tick)) {
}

void Replay::run(const std::vector<std::size_t>& wanted, bool counting, const std::function<void(std::size_t)>& seen) {
  if (wanted.empty()) return;
  const bool everything = m_session.info().history != History::none;
  m_session.reset();
  for (std::size_t i = 0; i <= wanted.back(); ++i) {
    const bool isWanted = std::binary_search(wanted.begin(), wanted.end(), i);
    if (!everything && !isWanted) continue;
    m_session.draw(m_trace.phases[i], i, StampMode::headline, counting && isWanted);
    if (isWanted) seen(i);
    m_tick();
  }
}

std::vector<CounterRow> Replay::count(std::map<std::size_t, std::vector<Picture>>& captured) {
  std::vector<CounterRow> rows;
  if (m_session.info().counters.empty() && m_session.info().layers.empty()) return rows;
  std::vector<std::size_t> wanted;
  for (std::size_t i = m_trace.lastOrbitBegin; i < m_trace.phases.size(); ++i)
    wanted.push_back(i);
  run(wanted, true, [&](std::size_t i) {
    const int frame = static_cast<int>(i - m_trace.lastOrbitBegin);
    if (!m_session.info().counters.empty())
      rows.push_back({frame, m_trace.phases[i], m_session.technique().counters()});
    if (const auto found = captured.find(i); found != captured.end()) m_session.addLayers(found->second);
  });
  return rows;
}

std::vector<std::size_t> Replay::capturedFrames(int count) const {
  const std::size_t frames = m_trace.phases.size() - m_trace.lastOrbitBegin;
  std::vector<std::size_t> wanted;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    wanted.push_back(m_trace.lastOrbitBegin + i * frames / static_cast<std::size_t>(count));
  wanted.push_back(m_trace.phases.size() - 1);
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  return wanted;
}

std::map<std::size_t, std::vector<Picture>> Replay::draw(const std::vector<std::size_t>& wanted) {
  std::map<std::size_t, std::vector<Picture>> pictures;
  run(wanted, false, [&](std::size_t i) { pictures[i] = m_session.pictures(); });
  return pictures;
}

RunCheck compareTimedWithReplay(const std::vector<Picture>& timed, const std::vector<std::vector<Picture>>& replays,
                                bool deterministic) {
  RunCheck check{"timed_frame_equals_replay", true, ""};
  const double difference = largestDifference(timed, replays.front());
  if (deterministic) {
    check.passed = equalBits(timed, replays.front());
    check.detail = check.passed ? "equal bits" : fmt::format("largest difference {:.3g}", difference);
    return check;
  }
  double spread = 0;
  for (std::size_t i = 1; i < replays.size(); ++i)
    spread = std::max(spread, largestDifference(replays.front(), replays[i]));
  // The timed frame is one more draw from the same distribution; twice the spread of three allows for that.
  check.passed = difference <= 2 * spread;
  check.detail =
      fmt::format("largest difference {:.3g}, spread of {} replays {:.3g}", difference, replays.size(), spread);
  return check;
}

RunCheck compareWithFreshState(Session& session, const Trace& trace, std::size_t frame,
                               const std::vector<Picture>& replayed) {
  session.reset();
  session.draw(trace.phases[frame], frame, StampMode::headline);
  const std::vector<Picture> fresh = session.pictures();
  RunCheck check{"history_does_not_show", equalBits(fresh, replayed), "equal bits"};
  if (!check.passed) check.detail = fmt::format("largest difference {:.3g}", largestDifference(fresh, replayed));
  return check;
}

} // namespace volmark
