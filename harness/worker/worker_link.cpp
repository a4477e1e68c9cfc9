#include "worker/worker_link.h"

#include "volmark/error.h"
#include "worker/worker_process.h"

#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace volmark {

namespace {

/// For an idle worker to end: drivers join their threads, sanitizers look for leaks.
constexpr int kGraceMs = 10000;

/// In the child, between fork and exec: only async-signal-safe calls.
[[noreturn]] void becomeWorker(const char* program, pid_t parent, int readFd, int writeFd) {
  // If memory runs out, the system ends a worker, not the runner that writes down why.
  if (const int score = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC); score >= 0) {
    [[maybe_unused]] const auto ignored = ::write(score, "800", 3);
    ::close(score);
  }
  ::setpgid(0, 0); // Ctrl-C on the terminal is the runner's business
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);
  // The pipes may themselves be 3 or 4: move them out of the way first.
  const int safeRead = ::fcntl(readFd, F_DUPFD, 10);
  const int safeWrite = ::fcntl(writeFd, F_DUPFD, 10);
  ::dup2(safeRead, kWorkerReadFd);
  ::dup2(safeWrite, kWorkerWriteFd);
  const int null = ::open("/dev/null", O_RDONLY);
  ::dup2(null, STDIN_FILENO);
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
  ::close(safeRead);
  ::close(safeWrite);
  char name[] = "volmark";
  char command[] = "worker";
  char* arguments[] = {name, command, nullptr};
  ::execv(program, arguments);
  ::_exit(127);
}

} // namespace

WorkerLink::WorkerLink(const std::filesystem::path& program) {
  int toChild[2];
  int fromChild[2];
  if (::pipe2(toChild, O_CLOEXEC) != 0 || ::pipe2(fromChild, O_CLOEXEC) != 0)
    throw DeviceError(fmt::format("no pipe for a worker process: {}", std::strerror(errno)));

  const pid_t parent = ::getpid();
  m_pid = ::fork();
  if (m_pid < 0) throw DeviceError(fmt::format("no process for a worker: {}", std::strerror(errno)));
  if (m_pid == 0) becomeWorker(program.c_str(), parent, toChild[0], fromChild[1]);

  ::close(toChild[0]);
  ::close(fromChild[1]);
  m_toChild = toChild[1];
  m_fromChild = fromChild[0];
  m_channel = std::make_unique<LineChannel>(m_fromChild, m_toChild);
}

WorkerLink::~WorkerLink() {
  ::close(m_toChild);
  if (!m_idle || !endsByItself()) kill();
  ::close(m_fromChild);
}

bool WorkerLink::endsByItself() {
  for (int i = 0; i < kGraceMs / 5; ++i) {
    if (m_pid <= 0 || ::waitpid(m_pid, nullptr, WNOHANG) == m_pid) {
      m_pid = -1;
      return true;
    }
    ::usleep(5000);
  }
  return false;
}

std::uint64_t WorkerLink::privateBytes() const {
  std::ifstream file(fmt::format("/proc/{}/status", m_pid));
  std::uint64_t kib = 0;
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("RssAnon:") || line.starts_with("RssShmem:") || line.starts_with("VmSwap:"))
      kib += std::strtoull(line.c_str() + line.find(':') + 1, nullptr, 10);
  return kib * 1024;
}

void WorkerLink::describe() {
  m_channel->send({{"describe", kWorkerProtocol}});
}

void WorkerLink::start(const WorkerStart& start) {
  m_idle = false;
  m_channel->send({{"start", start}});
}

void WorkerLink::grant(const std::string& turn, const TurnRow& place) {
  m_channel->send({{"turn", turn}, {"orbit", place.orbit}, {"place", place.place}, {"of", place.of}});
}

WorkerLink::Answer WorkerLink::wait(int timeoutMs) {
  nlohmann::json message;
  switch (m_channel->receive(message, timeoutMs)) {
  case LineChannel::Result::timeout: return {};
  case LineChannel::Result::closed: return {Answer::Kind::died, {}, reap()};
  case LineChannel::Result::message: break;
  }
  if (message.contains("described")) return {Answer::Kind::described, message["described"], ""};
  if (message.contains("failed")) return {Answer::Kind::failed, message, ""};
  if (message.contains("done")) {
    m_idle = message["done"] == "finish";
    return {Answer::Kind::done, message, ""};
  }
  return {Answer::Kind::frames, message, ""};
}

void WorkerLink::kill() {
  if (m_pid <= 0) return;
  ::kill(m_pid, SIGKILL);
  reap();
}

std::string WorkerLink::reap() {
  if (m_pid <= 0) return "gone";
  int status = 0;
  while (::waitpid(m_pid, &status, 0) < 0 && errno == EINTR) {
  }
  m_pid = -1;
  // Nobody but the system sends SIGKILL to a worker that isn't over a limit.
  const char* hint =
      WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL ? "; the machine may have run out of memory" : "";
  if (WIFSIGNALED(status)) return fmt::format("signal {} ({}){}", WTERMSIG(status), strsignal(WTERMSIG(status)), hint);
  return fmt::format("exit code {}", WEXITSTATUS(status));
}

} // namespace volmark
