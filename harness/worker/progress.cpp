#include "worker/progress.h"

#include "measure/clocks.h"

#include <fmt/format.h>

#include <unistd.h>

namespace volmark {

namespace {

/// Between two lines where the output is no terminal.
constexpr double kPlainIntervalMs = 15000;
constexpr double kTerminalIntervalMs = 200;

} // namespace

std::string durationText(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole >= 3600) return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
  if (whole >= 60) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} s", whole);
}

Progress::Progress(std::FILE* stream) : m_stream(stream), m_terminal(::isatty(::fileno(stream)) != 0) {
}

void Progress::start(int runs) {
  m_runs = runs;
  m_startMs = monotonicMs();
}

std::string Progress::status() const {
  const double elapsed = (monotonicMs() - m_startMs) / 1000;
  std::string text = fmt::format("{:.0f} of {} runs", m_done, m_runs);
  if (m_done > 0.02 && elapsed > 1) {
    const double rate = m_done / elapsed;
    text += fmt::format(", {:.1f} a minute, {} left", rate * 60, durationText((m_runs - m_done) / rate));
  }
  return text + ": " + m_what;
}

void Progress::advanceTo(double runs, const std::string& what) {
  m_done = runs;
  m_what = what;
  const double now = monotonicMs();
  if (now - m_lastMs < (m_terminal ? kTerminalIntervalMs : kPlainIntervalMs)) return;
  m_lastMs = now;
  if (m_terminal) {
    fmt::print(m_stream, "\r\033[K{}", status());
    m_drawn = true;
  } else {
    fmt::print(m_stream, "{}\n", status());
  }
  std::fflush(m_stream);
}

void Progress::say(const std::string& line) {
  if (m_drawn) fmt::print(m_stream, "\r\033[K");
  m_drawn = false;
  fmt::print(m_stream, "{}\n", line);
  std::fflush(m_stream);
}

void Progress::finish() {
  if (m_drawn) fmt::print(m_stream, "\r\033[K");
  m_drawn = false;
  std::fflush(m_stream);
}

} // namespace volmark
