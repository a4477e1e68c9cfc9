// volmark run
#include "cli/commands.h"
#include "scenario/point_list.h"
#include "scenario/scenario.h"
#include "worker/runner.h"

#include <fmt/format.h>

#include <memory>

namespace volmark {

namespace {

struct RunArguments {
  std::string config;
  std::string profile;
  std::vector<std::string> assignments;
  std::string results = "results";
  std::vector<std::string> data;
  std::string device;
  bool validate = false;
  std::string retry;
  std::string points;
  std::vector<std::string> builds;
  bool noIndex = false;
  double maximumGib = kDefaultMaximumGib;
  double memoryGib = 0;
};

int exitCodeOf(const RunnerResult& result) {
  if (result.interrupted) return 130;
  return result.failed > 0 ? 1 : 0;
}

void printSummary(const RunnerResult& result) {
  std::string line = fmt::format("{} completed", result.completed);
  if (result.alreadyDone > 0) line += fmt::format(", {} done before", result.alreadyDone);
  if (result.elsewhere > 0) line += fmt::format(", {} under way elsewhere", result.elsewhere);
  if (result.failed > 0) line += fmt::format(", {} FAILED (--retry failed runs them again)", result.failed);
  if (result.unsupported > 0) line += fmt::format(", {} unsupported here", result.unsupported);
  fmt::print("{}\nresults: {}\n", line, result.folder.string());
  if (result.interrupted)
    fmt::print("interrupted: the same command goes on from here\n");
  else
    fmt::print("report:  PYTHONPATH=analysis python3 -m volmark_analysis report {}\n", result.folder.string());
}

int run(const RunArguments& arguments) {
  const Places places = findPlaces();
  const TechniqueCatalogue catalogue = loadCatalogue();
  ScenarioOptions scenario{arguments.config, arguments.profile, arguments.assignments, places.scenes,
                           places.configs / "profiles"};
  RunnerOptions options;
  options.resultsFolder = arguments.results;
  options.scenesFolder = places.scenes;
  options.techniqueFolders = techniqueFolders();
  options.data = dataFolders(arguments.data, places);
  options.device = arguments.device;
  options.validate = arguments.validate;
  options.retryFailed = arguments.retry == "failed";
  options.maximumBytes = bytesOfGib(arguments.maximumGib);
  options.writeIndex = !arguments.noIndex;
  if (arguments.memoryGib > 0) options.workerBytes = bytesOfGib(arguments.memoryGib);
  for (const std::string& build : arguments.builds)
    options.builds.push_back(parseBuild(build));
  Scenario expanded = readScenario(scenario, catalogue);
  if (!arguments.points.empty())
    options.points = parsePointList(arguments.points, static_cast<int>(expanded.points.size()), "--points");
  Progress progress(stderr);
  const RunnerResult result = runScenario(std::move(expanded), catalogue, options, progress);
  printSummary(result);
  return exitCodeOf(result);
}

} // namespace

void addRunCommand(CLI::App& app, int& exitCode) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "Run a scenario, or what is left of it");
  command->add_option("CONFIG", arguments->config, "Scenario file (configs/*.json)")->required();
  command->add_option("--profile", arguments->profile, "paper, desktop, lavapipe, smoke, or one of the file's own");
  command->add_option("--set", arguments->assignments, "Change a setting of every point: key.path=value")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--points", arguments->points, "Only these points of volmark expand, as in 3,7-12");
  command
      ->add_option("--build", arguments->builds,
                   "NAME=PROGRAM, more than once: every point is run by each of these builds of volmark, interleaved")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--results", arguments->results, "Folder of experiments")->capture_default_str();
  command->add_option("--data", arguments->data, "Folder with volumes, before VOLMARK_DATA and scenes/data");
  command->add_option("--device", arguments->device, "Index or part of the name (volmark device)");
  command->add_flag("--validate", arguments->validate, "Vulkan validation layers; any message fails a run's check");
  command->add_option("--retry", arguments->retry, "failed: run again what did not complete")
      ->check(CLI::IsMember({"failed"}));
  command->add_flag("--no-index", arguments->noIndex, "Leave index.csv alone (volmark index writes it)");
  command->add_option("--max-volume-gib", arguments->maximumGib, "Largest volume to load")->capture_default_str();
  command->add_option(
      "--memory-gib", arguments->memoryGib,
      "Most memory that interleaved workers use together; where it is too short for all of a group they "
      "run one after the other (default: what the machine has available)");
  command->callback([arguments, &exitCode] { exitCode = run(*arguments); });
}

} // namespace volmark
