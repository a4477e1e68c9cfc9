// volmark draw: the timed path alone, in this process, for profilers.
#include "cli/commands.h"
#include "scenario/point_list.h"
#include "scenario/scenario.h"
#include "volmark/error.h"
#include "worker/session.h"
#include "worker/timed_pass.h"

#include <fmt/format.h>

#include <memory>

namespace volmark {

namespace {

struct DrawArguments {
  std::string config;
  std::string profile;
  std::vector<std::string> assignments;
  int point = 0;
  int orbits = 1;
  std::vector<std::string> data;
  std::string device;
  double maximumGib = kDefaultMaximumGib;
};

int draw(const DrawArguments& arguments) {
  const Places places = findPlaces();
  const TechniqueCatalogue catalogue = loadCatalogue();
  const Scenario scenario = readScenario(
      {arguments.config, arguments.profile, arguments.assignments, places.scenes, places.configs / "profiles"},
      catalogue);
  parsePointList(std::to_string(arguments.point), static_cast<int>(scenario.points.size()), "--point");
  const PointSettings& settings = scenario.points[static_cast<std::size_t>(arguments.point)].settings;
  if (settings.pacing.mode != PacingSettings::Mode::frames)
    throw InputError("draw: found timed pacing, allowed: pacing.mode frames, so that every call does the same work");

  auto volume = openVolume(settings.scene, dataFolders(arguments.data, places), bytesOfGib(arguments.maximumGib));
  Session session(settings, catalogue.get(settings.technique), std::move(volume), {arguments.device, false});
  session.prepare();
  TimedPass timed(session, [] {});
  timed.warmUp();
  for (int orbit = 0; orbit < arguments.orbits; ++orbit)
    timed.orbit(OrbitKind::headline, orbit);
  fmt::print("{}: {} frames\n", settings.technique, arguments.orbits * settings.pacing.frames);
  return 0;
}

} // namespace

void addDrawCommand(CLI::App& app, int& exitCode) {
  auto arguments = std::make_shared<DrawArguments>();
  CLI::App* command = app.add_subcommand("draw", "Draw a point's frames and write nothing, under a profiler");
  command->footer("perf record volmark draw CONFIG --point 2 --orbits 20\n"
                  "Two calls that differ only in --orbits differ by exactly the work of those orbits.");
  command->add_option("CONFIG", arguments->config, "Scenario file")->required();
  command->add_option("--point", arguments->point, "Its number (volmark expand)")->capture_default_str();
  command->add_option("--orbits", arguments->orbits, "How often the timeline is drawn after warming up")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000000));
  command->add_option("--profile", arguments->profile, "paper, desktop, lavapipe, smoke, or one of the file's own");
  command->add_option("--set", arguments->assignments, "Change a setting: key.path=value")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--data", arguments->data, "Folder with volumes");
  command->add_option("--device", arguments->device, "Index or part of the name (volmark device)");
  command->add_option("--max-volume-gib", arguments->maximumGib, "Largest volume to load")->capture_default_str();
  command->callback([arguments, &exitCode] { exitCode = draw(*arguments); });
}

} // namespace volmark
