#include "scenario/documents.h"

#include "scenario/assignment.h"
#include "scenario/document_check.h"
#include "scenario/overrides.h"
#include "scenario/point_keys.h"
#include "volmark/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace volmark {

namespace {

using Ordered = nlohmann::ordered_json;

bool isIndex(const std::string& key) {
  return !key.empty() && key.size() <= 6 &&
         std::all_of(key.begin(), key.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// Values of a flat set are replaced as a whole: {"raw"} does not merge into {"normalized"}.
void mergeSet(Ordered& target, const Ordered& patch) {
  if (!target.is_object()) target = Ordered::object();
  for (const auto& [path, value] : patch.items()) {
    if (!value.is_null()) continue;
    std::vector<std::string> forgotten;
    for (const auto& [known, ignored] : target.items())
      if (isWithin(known, path)) forgotten.push_back(known);
    for (const std::string& known : forgotten)
      target.erase(known);
  }
  for (const auto& [path, value] : patch.items())
    if (!value.is_null()) target[path] = value;
}

void mergePatch(Ordered& target, const Ordered& patch, const std::string& place);

/// {"0": {...}} patches one element of an array, which RFC 7396 can't say.
void mergeElements(Ordered& target, const Ordered& patch, const std::string& place) {
  for (const auto& [key, value] : patch.items()) {
    const std::size_t index = std::stoul(key);
    if (index >= target.size())
      throw InputError(
          fmt::format("{}: found number {}, allowed: 0 to {}", place, index, std::ptrdiff_t(target.size()) - 1));
    mergePatch(target[index], value, place);
  }
}

bool patchesElements(const Ordered& target, const Ordered& patch) {
  if (!target.is_array() || patch.empty()) return false;
  for (const auto& [key, ignored] : patch.items())
    if (!isIndex(key)) return false;
  return true;
}

/// JSON merge patch (RFC 7396) with two additions: flat sets and elements by number.
void mergePatch(Ordered& target, const Ordered& patch, const std::string& place) {
  if (!patch.is_object()) {
    target = patch;
    return;
  }
  if (patchesElements(target, patch)) return mergeElements(target, patch, place);
  if (!target.is_object()) target = Ordered::object();
  for (const auto& [key, value] : patch.items()) {
    if (value.is_null())
      target.erase(key);
    else if (key == "set" && value.is_object())
      mergeSet(target[key], value);
    else
      mergePatch(target[key], value, place);
  }
}

// --- Profiles ------------------------------------------------------------------------------------------------

std::vector<std::string> profileNames(const ScenarioOptions& options, const Ordered& file) {
  std::vector<std::string> names;
  std::error_code code;
  for (std::filesystem::directory_iterator entry(options.profilesFolder, code);
       !code && entry != std::filesystem::directory_iterator(); entry.increment(code))
    if (entry->path().extension() == ".json") names.push_back(entry->path().stem().string());
  if (const auto own = file.find("profiles"); own != file.end())
    for (const auto& [name, ignored] : own->items())
      names.push_back(name);
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

Ordered readProfileFile(const std::filesystem::path& path) {
  Ordered profile = readOrderedJsonFile(path);
  const nlohmann::json plain = profile;
  checkDocument(JsonValue(plain, path.string()), DocumentKind::profileFile);
  flattenSets(profile, path.string());
  // What describes the profile doesn't describe the scenario.
  for (const char* key : {"volmark", "$schema", "title", "description"})
    profile.erase(key);
  return profile;
}

void mergeProfiles(const ScenarioOptions& options, const Ordered& file, Ordered& document) {
  if (options.profile.empty()) return;
  const std::vector<std::string> names = profileNames(options, file);
  if (std::find(names.begin(), names.end(), options.profile) == names.end()) {
    const std::string nearest = suggestion(options.profile, names);
    throw InputError(fmt::format("{}: unknown profile {}{} allowed: {}", options.file.string(),
                                 shortJson(options.profile), nearest.empty() ? "," : nearest, quotedList(names)));
  }
  const std::filesystem::path path = options.profilesFolder / (options.profile + ".json");
  std::error_code code;
  if (std::filesystem::is_regular_file(path, code)) mergePatch(document, readProfileFile(path), path.string());
  if (const auto own = file.find("profiles"); own != file.end() && own->contains(options.profile))
    mergePatch(document, (*own)[options.profile], options.file.string());
}

// --- Assignments ---------------------------------------------------------------------------------------------

bool isOfDocument(const std::string& path) {
  const std::string first = path.substr(0, path.find('.'));
  return first == "title" || first == "description" || first == "set" || first == "blocks" || first == "limits" ||
         first == "sample";
}

Ordered nestedPatch(const std::string& path, Ordered value) {
  Ordered patch = std::move(value);
  for (std::string rest = path; !rest.empty();) {
    const std::size_t dot = rest.rfind('.');
    Ordered outer = Ordered::object();
    outer[rest.substr(dot == std::string::npos ? 0 : dot + 1)] = std::move(patch);
    patch = std::move(outer);
    rest.resize(dot == std::string::npos ? 0 : dot);
  }
  return patch;
}

/// An assigned path wins over blocks: over their sets, and an axis along it shrinks to the one value.
void assignInBlock(Ordered& block, const std::string& path, const Ordered& value, const std::string& place) {
  if (const auto set = block.find("set"); set != block.end()) {
    Ordered forget = Ordered::object();
    forget[path] = nullptr;
    mergeSet(*set, forget);
  }
  const auto axes = block.find("axes");
  if (axes == block.end()) return;
  for (auto& [name, axis] : axes->items()) {
    const std::string along = axis.value("path", "");
    if (along == path) {
      axis["values"] = Ordered::array({value});
      continue;
    }
    bool overlaps = !along.empty() && (isWithin(along, path) || isWithin(path, along));
    for (const auto& one : axis["values"])
      if (one.is_object() && one.contains("set"))
        for (const auto& [set_path, ignored] : one["set"].items())
          overlaps = overlaps || isWithin(set_path, path) || isWithin(path, set_path);
    if (overlaps)
      throw InputError(fmt::format("{}: the axis \"{}\" sets it too; assign blocks.<number>.axes.{}.values instead",
                                   place, name, name));
  }
}

void assign(const std::string& assignment, Ordered& document) {
  const auto& [path, given, place] = parseAssignment(assignment);
  Ordered patch = Ordered::object();
  if (isOfDocument(path))
    patch = nestedPatch(path, given);
  else
    patch["set"][path] = given;
  const nlohmann::json plain = patch;
  if (isOfDocument(path))
    checkDocument(JsonValue(plain, place), DocumentKind::patch);
  else
    readOverrides(JsonValue(plain["set"], place));
  flattenSets(patch, place);
  if (!isOfDocument(path) && document.contains("blocks"))
    for (const auto& [leaf, value] : patch["set"].items())
      for (auto& block : document["blocks"])
        assignInBlock(block, leaf, value, place);
  mergePatch(document, patch, place);
}

} // namespace

ScenarioDocument readDocument(const ScenarioOptions& options) {
  ScenarioDocument result;
  result.place = options.file.string();
  Ordered file = readOrderedJsonFile(options.file);
  const nlohmann::json plainFile = file;
  checkDocument(JsonValue(plainFile, result.place), DocumentKind::file);
  flattenSets(file, result.place);

  result.json = file;
  result.json.erase("profiles");
  result.json.erase("$schema");
  mergeProfiles(options, file, result.json);
  if (!options.profile.empty()) result.place += fmt::format(" (profile {})", options.profile);
  for (const std::string& assignment : options.assignments)
    assign(assignment, result.json);

  // Patches may fit a document only in part: an axis's values to its path, for one.
  const nlohmann::json merged = result.json;
  checkDocument(JsonValue(merged, result.place), DocumentKind::file);
  return result;
}

} // namespace volmark
