// volmark expand, validate, schema: scenarios without running them.
#include "cli/commands.h"
#include "scenario/scenario.h"
#include "worker/progress.h"

#include <fmt/format.h>

#include <memory>

namespace volmark {

namespace {

struct ScenarioArguments {
  std::vector<std::string> configs;
  std::string profile;
  std::vector<std::string> assignments;
  double frameMs = 100;
  std::string what = "scenario";
};

Scenario read(const std::string& config, const ScenarioArguments& arguments, const TechniqueCatalogue& catalogue) {
  const Places places = findPlaces();
  return readScenario({config, arguments.profile, arguments.assignments, places.scenes, places.configs / "profiles"},
                      catalogue);
}

int viewsOf(const PointSettings& settings) {
  return settings.stereo.enabled ? 2 : 1;
}

/// Wall time of one run, without preparation and reference, at an assumed time of a frame.
double secondsOf(const PointSettings& settings, double frameMs) {
  const PacingSettings& pacing = settings.pacing;
  const double replayed = (pacing.frames + settings.pictures.count) * frameMs / 1000;
  if (pacing.mode == PacingSettings::Mode::timed) return pacing.warmUpSeconds + pacing.seconds * 2 + replayed;
  const int frames = pacing.warmUpFrames + pacing.frames * (pacing.orbits + settings.measure.breakdownOrbits);
  return frames * frameMs / 1000 + replayed;
}

/// Pictures as half RGBA and float Z, about two thirds after compression, and their references.
double bytesOf(const PointSettings& settings) {
  const double pixels = double(settings.width) * settings.height * viewsOf(settings);
  const int pictures = settings.pictures.count + 1;
  return pictures * pixels * 12 * 0.66 * (settings.pictures.reference == "none" ? 1 : 2);
}

int expand(const ScenarioArguments& arguments) {
  const TechniqueCatalogue catalogue = loadCatalogue();
  const Scenario scenario = read(arguments.configs.front(), arguments, catalogue);
  int runs = 0;
  double seconds = 0;
  double bytes = 0;
  for (const Point& point : scenario.points) {
    nlohmann::ordered_json line{{"index", point.index}};
    for (const Label& label : point.labels)
      line["labels"][label.axis] = label.value;
    line["group"] = point.group;
    line["config"] = point.config;
    fmt::print("{}\n", line.dump());
    const int replicates = point.settings.measure.replicates;
    runs += replicates;
    seconds += replicates * secondsOf(point.settings, arguments.frameMs);
    bytes += replicates * bytesOf(point.settings);
  }
  fmt::print(stderr, "{} points, {} runs, about {:.2f} hours at {} ms a frame (--frame-ms), at most {:.1f} MB\n",
             scenario.points.size(), runs, seconds / 3600, arguments.frameMs, bytes / 1e6);
  return 0;
}

int validate(const ScenarioArguments& arguments) {
  const TechniqueCatalogue catalogue = loadCatalogue();
  const Places places = findPlaces();
  const DataFolders data = dataFolders({}, places);
  for (const std::string& config : arguments.configs) {
    const Scenario scenario = read(config, arguments, catalogue);
    fmt::print("{}: valid, {} points\n", config, scenario.points.size());
    std::string last;
    for (const Point& point : scenario.points) {
      const SceneDescription& scene = point.settings.scene;
      const bool file = !std::holds_alternative<GeneratorSource>(scene.source);
      if (file && scene.name != last && !findVolumeFile(scene, data))
        fmt::print("{}: note: the volume of scene \"{}\" is not here{}\n", config, scene.name,
                   scene.fetchHint.empty() ? "" : "; " + scene.fetchHint + " gets it");
      last = scene.name;
    }
  }
  return 0;
}

int schema(const ScenarioArguments& arguments) {
  const nlohmann::json document = arguments.what == "scene" ? sceneSchema() : scenarioSchema(loadCatalogue());
  fmt::print("{}\n", document.dump(2));
  return 0;
}

void addScenarioOptions(CLI::App& command, ScenarioArguments& arguments) {
  command.add_option("--profile", arguments.profile, "paper, desktop, lavapipe, smoke, or one of the file's own");
  command.add_option("--set", arguments.assignments, "Change a setting of every point: key.path=value")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

} // namespace

void addExpandCommand(CLI::App& app, int& exitCode) {
  auto arguments = std::make_shared<ScenarioArguments>();
  CLI::App* command = app.add_subcommand("expand", "Show a scenario's points as JSON lines; count, hours and bytes");
  command->add_option("CONFIG", arguments->configs, "Scenario file")->required()->expected(1);
  addScenarioOptions(*command, *arguments);
  command->add_option("--frame-ms", arguments->frameMs, "Time of a frame that the estimate assumes")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->callback([arguments, &exitCode] { exitCode = expand(*arguments); });
}

void addValidateCommand(CLI::App& app, int& exitCode) {
  auto arguments = std::make_shared<ScenarioArguments>();
  CLI::App* command = app.add_subcommand("validate", "Check scenario files without running them");
  command->add_option("CONFIG", arguments->configs, "Scenario files")->required();
  addScenarioOptions(*command, *arguments);
  command->callback([arguments, &exitCode] { exitCode = validate(*arguments); });
}

void addSchemaCommand(CLI::App& app, int& exitCode) {
  auto arguments = std::make_shared<ScenarioArguments>();
  CLI::App* command = app.add_subcommand("schema", "JSON Schema of scenario or scene files, for editors");
  command->add_option("WHAT", arguments->what, "scenario or scene")
      ->check(CLI::IsMember({"scenario", "scene"}))
      ->capture_default_str();
  command->callback([arguments, &exitCode] { exitCode = schema(*arguments); });
}

} // namespace volmark
