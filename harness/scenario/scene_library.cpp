#include "scenario/scene_library.h"

#include "volume/volume_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace volmark {

namespace {

bool isPath(const std::string& name) {
  return name.find('/') != std::string::npos || name.ends_with(".json") || isVolumeFileName(name);
}

std::vector<std::string> scenesIn(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code code;
  for (std::filesystem::directory_iterator entry(folder, code); !code && entry != std::filesystem::directory_iterator();
       entry.increment(code))
    if (entry->path().extension() == ".json") names.push_back(entry->path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// Empty if there is no such file or folder.
std::filesystem::path findPath(const std::filesystem::path& path, const std::filesystem::path& besides) {
  std::error_code code;
  for (const std::filesystem::path& candidate : {path, besides.parent_path() / path})
    if (std::filesystem::exists(candidate, code)) return candidate;
  return {};
}

} // namespace

SceneLibrary::Entry SceneLibrary::load(const JsonValue& value) const {
  const std::string name = value.text();
  if (isPath(name)) {
    const std::filesystem::path path = findPath(name, value.file());
    if (path.empty()) value.fail(fmt::format("found no scene file {}", shortJson(value.json(), 300)));
    return {path.string(), path.extension() == ".json" ? readScene(path) : sceneForFile(path)};
  }
  const std::filesystem::path path = m_folder / (name + ".json");
  std::error_code code;
  if (std::filesystem::is_regular_file(path, code)) return {name, readScene(path)};
  if (std::filesystem::exists(name, code)) return {name, sceneForFile(name)};
  const std::vector<std::string> names = scenesIn(m_folder);
  const std::string nearest = suggestion(name, names);
  value.fail(fmt::format("unknown scene {}{} allowed: {}", shortJson(value.json()), nearest.empty() ? "," : nearest,
                         names.empty() ? fmt::format("none is in {}", m_folder.string())
                                       : fmt::format("{} or a path", fmt::join(names, ", "))));
}

const SceneLibrary::Entry& SceneLibrary::get(const JsonValue& name) {
  const std::string key = name.text();
  const auto found = m_entries.find(key);
  return found != m_entries.end() ? found->second : m_entries.emplace(key, load(name)).first->second;
}

} // namespace volmark
