// The child's side: runs from start to committed results, one after the other, one turn at a time.
#pragma once

namespace volmark {

/// File descriptors that a worker process gets.
inline constexpr int kWorkerReadFd = 3;
inline constexpr int kWorkerWriteFd = 4;

/// Serves turns until a run fails or the runner is gone. Returns the process's exit code.
int serveTurns();

} // namespace volmark
