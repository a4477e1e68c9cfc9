// configs/*.json: defaults < file < profile < the file's profiles.<name> < --set, then expansion of blocks
// and axes to points.
#pragma once

#include "scenario/point.h"
#include "technique/catalogue.h"

#include <filesystem>
#include <string>
#include <vector>

namespace volmark {

struct ScenarioOptions {
  std::filesystem::path file;
  std::string profile;                  ///< "" or a name in configs/profiles/ or the file's profiles
  std::vector<std::string> assignments; ///< "key.path=value"; value is JSON, or a bare word as text
  std::filesystem::path scenesFolder;
  std::filesystem::path profilesFolder;
};

/// Caps from a profile. Applied before expansion to every point; the resolved config shows the result.
struct Limits {
  std::optional<std::int64_t> pixels; ///< per view: resolution is scaled down, aspect kept
  std::optional<std::int64_t> voxels; ///< generated volumes are made smaller, files over it are refused
  std::optional<std::int64_t> frames; ///< per orbit
};

struct Scenario {
  std::string name;
  std::string title;
  std::string description;
  std::filesystem::path file;
  std::string profile;
  std::vector<std::string> assignments;
  nlohmann::json document;       ///< merged, before expansion
  std::vector<std::string> axes; ///< names in order of first appearance
  std::vector<Point> points;     ///< in order: blocks, then axes with the last varying fastest
};

/// Reads, merges, checks and expands. Throws InputError; nothing is written.
Scenario readScenario(const ScenarioOptions& options, const TechniqueCatalogue& techniques);

/// One point without a scenario file (volmark render): `set` is what a scenario's "set" is, and "key.path=value"
/// assignments come on top. Throws InputError.
Point makePoint(const nlohmann::json& set, const std::vector<std::string>& assignments,
                const TechniqueCatalogue& techniques, const std::filesystem::path& scenesFolder);

/// JSON Schema (draft 2020-12) of scenario files; technique parameters come from the catalogue.
nlohmann::json scenarioSchema(const TechniqueCatalogue& techniques);
/// JSON Schema of scene files.
nlohmann::json sceneSchema();

} // namespace volmark
