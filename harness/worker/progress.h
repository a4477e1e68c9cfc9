// How far a grid is: one line that is drawn over on a terminal, plain lines elsewhere.
#pragma once

#include <cstdio>
#include <string>

namespace volmark {

class Progress {
public:
  /// Writes to `stream`; drawn over if that is a terminal.
  explicit Progress(std::FILE* stream);

  /// `runs`: to do now. `framesPerRun`: rough, only for the time left.
  void start(int runs);
  /// Work done within the current batch, in runs (fractions while a batch is under way).
  void advanceTo(double runs, const std::string& what);
  /// A line that stays.
  void say(const std::string& line);
  void finish();

private:
  std::string status() const;

  std::FILE* m_stream;
  bool m_terminal;
  int m_runs = 0;
  double m_done = 0;
  double m_startMs = 0;
  double m_lastMs = 0;
  std::string m_what;
  bool m_drawn = false;
};

/// "2 h 05 min", "3 min 20 s", "8 s".
std::string durationText(double seconds);

} // namespace volmark
