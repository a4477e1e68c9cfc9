#include "worker/worker_process.h"

#include "results/provenance.h"
#include "volmark/error.h"
#include "worker/worker_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <memory>
#include <new>
#include <sys/resource.h>
#include <unistd.h>

namespace volmark {

namespace {

namespace fs = std::filesystem;

/// Allocations over the limit fail in the process itself; what grows by other ways is seen by the runner.
void limitMemory(double gib) {
#ifndef __SANITIZE_ADDRESS__ // its shadow alone is larger
  rlimit limit{};
  if (::getrlimit(RLIMIT_DATA, &limit) != 0) return;
  limit.rlim_cur = gib > 0 ? std::min(limit.rlim_max, static_cast<rlim_t>(gib * 1024 * 1024 * 1024)) : limit.rlim_max;
  ::setrlimit(RLIMIT_DATA, &limit);
#else
  (void)gib;
#endif
}

/// Drivers print to both streams, and so does whatever kills the process.
void printInto(const fs::path& log) {
  const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file < 0) throw DeviceError(fmt::format("{}: can't be written: {}", log.string(), std::strerror(errno)));
  ::dup2(file, STDOUT_FILENO);
  ::dup2(file, STDERR_FILENO);
  ::close(file);
}

nlohmann::json description() {
  const TechniqueCatalogue catalogue(techniqueFolders());
  nlohmann::json techniques = nlohmann::json::object();
  for (const CatalogueEntry& entry : catalogue.entries())
    techniques[entry.factory->info.name] = {{"module_digest", entry.moduleDigest},
                                            {"build_digest", buildDigest(entry.moduleDigest)}};
  return {{"protocol", kWorkerProtocol}, {"commit", programVersion().commit}, {"techniques", techniques}};
}

std::string oneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

} // namespace

int serveTurns() {
  LineChannel runner(kWorkerReadFd, kWorkerWriteFd);
  WorkerMemory kept;
  std::unique_ptr<WorkerRun> run;
  const auto failed = [&](RunStatus status, const std::string& reason) {
    nlohmann::json known = run ? run->provenanceNow() : provenance(nullptr);
    runner.send({{"failed", nameOf(status)}, {"reason", oneLine(reason)}, {"provenance", std::move(known)}});
    return 0;
  };
  try {
    nlohmann::json message;
    while (runner.receive(message, -1) != LineChannel::Result::closed) {
      if (message.contains("describe")) {
        runner.send({{"described", description()}});
        break;
      }
      if (message.contains("start")) {
        const auto start = message["start"].get<WorkerStart>();
        printInto(fs::path(start.stagingFolder) / "log.txt");
        run = std::make_unique<WorkerRun>(start, runner, kept);
        limitMemory(run->settings().measure.memoryLimitGib);
        continue;
      }
      if (!message.contains("turn")) continue;
      const std::string turn = message["turn"];
      run->take(turn, {OrbitKind::headline, message["orbit"], message["place"], message["of"]});
      if (turn == "finish") run.reset();
      runner.send({{"done", turn}});
    }
    return 0;
  } catch (const UnsupportedError& error) {
    return failed(RunStatus::unsupported, error.what());
  } catch (const std::bad_alloc&) {
    limitMemory(0); // so that there is some to say it with
    return failed(RunStatus::outOfMemory, "out of host memory");
  } catch (const std::exception& error) {
    return failed(RunStatus::failed, error.what());
  }
}

} // namespace volmark
