#include "worker/worker_link.h"

#include "volmark/error.h"
#include "worker/worker_process.h"

#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace volmark {

namespace {

/// In the child, between fork and exec: only async-signal-safe calls.
[[noreturn]] void becomeWorker(const char* program, pid_t parent, int readFd, int writeFd) {
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
  kill();
  ::close(m_toChild);
  ::close(m_fromChild);
}

void WorkerLink::describe() {
  m_channel->send({{"describe", kWorkerProtocol}});
}

void WorkerLink::start(const WorkerStart& start) {
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
  if (message.contains("done")) return {Answer::Kind::done, message, ""};
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
  if (WIFSIGNALED(status)) return fmt::format("signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
  return fmt::format("exit code {}", WEXITSTATUS(status));
}

} // namespace volmark
