// The program: subcommands, exit codes, signals.
#include "cli/commands.h"
#include "volmark/build_id.h"
#include "volmark/error.h"
#include "worker/runner.h"
#include "worker/worker_process.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <csignal>

namespace {

using namespace volmark;

constexpr const char* kFooter = R"(Start here:
  volmark list                                             techniques, scenes and configurations
  volmark describe iso_raymarch                            what it does, its parameters with ranges
  volmark render --scene marschner_lobb --technique iso_raymarch -o first.exr
  volmark info scan.nii.gz                                 a volume's size, type, range and histogram
  volmark expand configs/quick/quick.json                  what a scenario would run, without running it
  volmark run configs/quick/quick.json                     run it; again: goes on where it was stopped
  volmark status results/quick                             how far it is

Exit codes: 0 all done; 1 at least one run failed; 2 bad input, nothing was run; 3 this machine lacks something
(device, driver, process); 130 interrupted, the same command goes on from there.

Environment: VOLMARK_DATA (folders of volumes, ':'-separated), VOLMARK_TECHNIQUES (folders of modules),
VOLMARK_SCENES (folder of scene files), VOLMARK_SHADERS (folders of live GLSL), VOLMARK_CACHE (default
~/.cache/volmark), VOLMARK_VOLUME_CACHE_GIB (most decoded volumes to keep there, default 32, 0 none).)";

extern "C" void requestInterrupt(int) {
  interruptRequested = true;
}

/// For `run`, which then ends in order. The other commands have nothing to lose and just end.
void installSignalHandlers() {
  struct sigaction action {};
  action.sa_handler = requestInterrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

/// Names of files are part of an error, and may hold anything.
void printError(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  fmt::print(stderr, "volmark: {}\n", text);
}

int parseAndRun(int argc, char** argv) {
  CLI::App app{"volmark measures volume and isosurface rendering techniques the way their papers did.", "volmark"};
  app.footer(kFooter);
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string(kSdkVersion));
  app.get_formatter()->column_width(34);

  int exitCode = 0;
  addRunCommand(app, exitCode);
  addRenderCommand(app, exitCode);
  addStatusCommand(app, exitCode);
  addIndexCommand(app, exitCode);
  addDrawCommand(app, exitCode);
  addExpandCommand(app, exitCode);
  addValidateCommand(app, exitCode);
  addInfoCommand(app, exitCode);
  addListCommand(app, exitCode);
  addDescribeCommand(app, exitCode);
  addDeviceCommand(app, exitCode);
  addSchemaCommand(app, exitCode);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : 2;
  }
  return exitCode;
}

} // namespace

int main(int argc, char** argv) {
  const std::string_view command = argc > 1 ? argv[1] : "";
  std::signal(SIGPIPE, SIG_IGN);
  if (command == "worker" && argc == 2) return serveTurns();
  if (command == "run") installSignalHandlers();
  try {
    return parseAndRun(argc, argv);
  } catch (const InputError& error) {
    printError(error.what());
    return 2;
  } catch (const std::exception& error) {
    printError(error.what());
    return 3;
  }
}
