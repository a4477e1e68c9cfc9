// One function per subcommand: its options, and what it does when chosen.
#pragma once

#include "scenario/scene_file.h"
#include "technique/catalogue.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace volmark {

void addRunCommand(CLI::App& app, int& exitCode);
void addRenderCommand(CLI::App& app, int& exitCode);
void addDrawCommand(CLI::App& app, int& exitCode);
void addStatusCommand(CLI::App& app, int& exitCode);
void addIndexCommand(CLI::App& app, int& exitCode);
void addExpandCommand(CLI::App& app, int& exitCode);
void addValidateCommand(CLI::App& app, int& exitCode);
void addInfoCommand(CLI::App& app, int& exitCode);
void addListCommand(CLI::App& app, int& exitCode);
void addDescribeCommand(CLI::App& app, int& exitCode);
void addDeviceCommand(CLI::App& app, int& exitCode);
void addSchemaCommand(CLI::App& app, int& exitCode);

/// Where scenes, configurations and volumes are looked for.
struct Places {
  std::filesystem::path scenes;
  std::filesystem::path configs;
};
/// VOLMARK_SCENES, else "scenes" of the working folder, else the source or installed one.
Places findPlaces();

/// --data, then VOLMARK_DATA, then <scenes>/data.
DataFolders dataFolders(const std::vector<std::string>& options, const Places& places);

/// All modules of techniqueFolders(); problems are printed to standard error.
TechniqueCatalogue loadCatalogue();

/// Largest volume that is loaded unless --max-volume-gib says otherwise.
inline constexpr double kDefaultMaximumGib = 4;
/// Throws InputError unless it is a size.
std::uint64_t bytesOfGib(double gib);

} // namespace volmark
