// Bookkeeping that all recorders share: which passes a frame had and how long each took on the host.
#pragma once

#include "volmark/frame_times.h"

#include <string>
#include <string_view>
#include <vector>

namespace volmark {

/// CLOCK_MONOTONIC, milliseconds.
double passClockMs();

struct LoggedPass {
  std::string name;
  bool onGpu = false;
  bool inUpdate = true;
  double beginMs = 0;
  double endMs = 0;
  int firstStamp = -1; ///< GPU passes that are stamped: query indices
  int lastStamp = -1;
};

class PassLog {
public:
  void clear();
  void markUpdateDone() { m_updating = false; }

  /// Throws std::logic_error when another pass is open.
  int begin(std::string_view name, bool onGpu);
  void end(int index) noexcept;
  bool isOpen() const { return m_open >= 0; }

  LoggedPass& pass(int index) { return m_passes.at(static_cast<std::size_t>(index)); }
  const std::vector<LoggedPass>& passes() const { return m_passes; }

private:
  std::vector<LoggedPass> m_passes;
  int m_open = -1;
  bool m_updating = true;
};

/// Adds one pass to `times.passes`, to the entry of the same name and place if there is one.
void addPassTime(FrameTimes& times, const RecordedPass& pass);

} // namespace volmark
