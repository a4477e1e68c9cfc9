// volmark status, index: an experiment's folder without running anything.
#include "results/status.h"

#include "cli/commands.h"
#include "results/experiment.h"
#include "worker/progress.h"

#include <fmt/format.h>

#include <memory>

namespace volmark {

namespace {

void print(const ExperimentStatus& status) {
  fmt::print("{}: {} of {} runs done ({} completed, {} failed, {} unsupported), {} running, {} left", status.name,
             status.completed + status.failed + status.unsupported, status.planned, status.completed, status.failed,
             status.unsupported, status.running, status.left);
  if (status.secondsLeft && status.left + status.running > 0)
    fmt::print(", about {} at the pace so far", durationText(*status.secondsLeft));
  fmt::print("\n");
  for (const ActiveProcess& process : status.active)
    fmt::print("  {} (process {}): {} run{}, heartbeat {} ago\n", process.host, process.pid, process.runs,
               process.runs == 1 ? "" : "s", durationText(std::max(0.0, process.heartbeatSeconds)));
  if (status.failed > 0) fmt::print("  volmark run ... --retry failed runs again what failed\n");
  if (status.builds > 1)
    fmt::print("  the runs come from {} builds or devices; of each point the newest is counted\n", status.builds);
}

int showStatus(const std::string& folder, bool asJson) {
  const ExperimentStatus status = readStatus(folder);
  if (asJson)
    fmt::print("{}\n", statusDocument(status).dump(1));
  else
    print(status);
  return 0;
}

int rebuildIndex(const std::string& folder) {
  const ExperimentStatus status = readStatus(folder); // refuses what isn't an experiment
  reopenExperiment(folder).writeIndex();
  fmt::print("{}: index of {} runs\n", status.name, status.completed + status.failed + status.unsupported);
  return 0;
}

} // namespace

void addStatusCommand(CLI::App& app, int& exitCode) {
  auto folder = std::make_shared<std::string>();
  auto asJson = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("status", "Tell how far an experiment is: done, running, failed, left, time");
  command->add_option("DIR", *folder, "Experiment folder, as in results/quick")->required();
  command->add_flag("--json", *asJson, "As JSON, with the points that are left");
  command->callback([folder, asJson, &exitCode] { exitCode = showStatus(*folder, *asJson); });
}

void addIndexCommand(CLI::App& app, int& exitCode) {
  auto folder = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("index", "Rebuild index.csv and google_benchmark.json from the runs");
  command->add_option("DIR", *folder, "Experiment folder, as in results/quick")->required();
  command->callback([folder, &exitCode] { exitCode = rebuildIndex(*folder); });
}

} // namespace volmark
