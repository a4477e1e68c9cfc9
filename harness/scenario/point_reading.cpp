#include "scenario/point_reading.h"

#include "scenario/assignment.h"
#include "scenario/point_keys.h"
#include "volmark/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <xxhash.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>

namespace volmark {

namespace {

/// Where errors about a key are reported: at its value, else at the point.
class Given {
public:
  Given(const Overrides& overrides, const JsonValue& place) : m_overrides(overrides), m_place(place) {}

  const Override* find(const std::string& path) const {
    const auto found = m_overrides.find(path);
    return found == m_overrides.end() ? nullptr : &found->second;
  }
  JsonValue require(const std::string& path) const {
    if (const Override* given = find(path)) return given->place();
    m_place.fail(fmt::format("key \"{}\" is missing", path));
  }
  [[noreturn]] void fail(const std::string& path, const std::string& message) const {
    if (const Override* given = find(path)) given->place().fail(message);
    m_place.fail(fmt::format("{}: {}", path, message));
  }

private:
  const Overrides& m_overrides;
  const JsonValue& m_place;
};

std::string nameOf(ShadingModel model) {
  PointSettings settings;
  settings.shading.model = model;
  return findPointKey("shading.model")->write(settings).get<std::string>();
}

ParameterValue parameterFrom(const nlohmann::json& json) {
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_number_unsigned() && json.get<std::uint64_t>() > static_cast<std::uint64_t>(INT64_MAX))
    return json.get<double>();
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_number()) return json.get<double>();
  return json.get<std::string>();
}

const TechniqueInfo& readTechnique(const Overrides& overrides, const Given& given, const TechniqueCatalogue& techniques,
                                   PointSettings& settings) {
  const JsonValue name = given.require("technique.name");
  settings.technique = name.text();
  const TechniqueInfo* info = nullptr;
  try {
    info = &techniques.get(settings.technique).factory->info;
  } catch (const InputError& error) {
    name.fail(error.what());
  }
  settings.parameters = ParameterValues(info->parameters);
  const std::string group = "technique.parameters.";
  for (auto entry = overrides.lower_bound(group); entry != overrides.end() && entry->first.starts_with(group);
       ++entry) {
    try {
      settings.parameters.set(entry->first.substr(group.size()), parameterFrom(entry->second.value));
    } catch (const InputError& error) {
      entry->second.place().fail(fmt::format("technique \"{}\": {}", settings.technique, error.what()));
    }
  }
  return *info;
}

/// Every scene has at least one isovalue and one transfer function.
void takeDefaults(const TechniqueInfo& technique, PointSettings& settings) {
  const SceneDescription& scene = settings.scene;
  assert(!scene.isovalues.empty() && !scene.transferFunctions.empty());
  settings.light = scene.light;
  settings.shading.model = technique.shadings.empty() ? ShadingModel::none : technique.shadings.front();
  // Pictures of a volume don't depend on an isovalue, and neither shall their hash.
  if (technique.draws != Draws::volume) settings.isovalue = scene.isovalues.front().second;
  settings.transferFunction = std::make_shared<TransferFunction>(scene.transferFunctions.front().second);
}

void checkTechnique(const Given& given, const TechniqueInfo& technique, const PointSettings& settings) {
  std::vector<ShadingModel> models = technique.shadings;
  if (models.empty()) models = {ShadingModel::none};
  if (std::find(models.begin(), models.end(), settings.shading.model) == models.end()) {
    std::vector<std::string> names;
    for (const ShadingModel model : models)
      names.push_back(nameOf(model));
    given.fail("shading.model", fmt::format("found \"{}\", allowed for technique \"{}\": {}",
                                            nameOf(settings.shading.model), technique.name, quotedList(names)));
  }
  if (settings.stereo.enabled && technique.maximumViews < 2)
    given.fail("stereo.enabled",
               fmt::format("found 2 views, technique \"{}\" draws at most {}", technique.name, technique.maximumViews));
  if (settings.shading.shadows && !technique.shadows)
    given.fail("shading.shadows", fmt::format("found true, technique \"{}\" draws no shadows", technique.name));
  if (settings.hiddenSegments.any() && !technique.segments)
    given.fail("hidden_segments", fmt::format("technique \"{}\" draws all segments; allowed: []", technique.name));
  if (settings.functionBeyond && !technique.functionBeyond)
    given.fail(
        "transfer_function_beyond",
        fmt::format("technique \"{}\" does not draw what clipping planes cut off; allowed: null", technique.name));
}

void checkCombination(const Given& given, const PointSettings& settings) {
  if (settings.hiddenSegments.any() && !settings.scene.labels)
    given.fail("hidden_segments", fmt::format("scene \"{}\" has no labels; allowed: []", settings.scene.name));
  if (settings.shading.shadows && !settings.light.isSpot())
    given.fail("shading.shadows",
               "found true, but only a spotlight casts shadows: \"light.spot\" true, \"light.headlight\" false");
  const CameraPath& camera = settings.timeline.camera;
  if (camera.kind == CameraPath::Kind::keys && camera.keys.empty())
    given.fail("timeline.keys", "path \"keys\" needs at least one key pose");
  const Framing& framing = settings.scene.framing;
  const double cosine = glm::dot(framing.up, framing.front) / (glm::length(framing.up) * glm::length(framing.front));
  if (!(std::abs(cosine) < 1e-6))
    given.fail(given.find("framing.front") ? "framing.front" : "framing.up", "up and front have to be orthogonal");
  if (const auto* source = std::get_if<GeneratorSource>(&settings.scene.source)) {
    try {
      checkGenerator(source->settings);
    } catch (const InputError& error) {
      given.fail("volume.generator.parameters", error.what());
    }
  }
}

} // namespace

PointSettings readSettings(const Overrides& overrides, const JsonValue& place, const TechniqueCatalogue& techniques,
                           SceneLibrary& scenes) {
  const Given given(overrides, place);
  PointSettings settings;
  const SceneLibrary::Entry& scene = scenes.get(given.require("scene"));
  settings.scene = scene.description;
  const TechniqueInfo& technique = readTechnique(overrides, given, techniques, settings);
  takeDefaults(technique, settings);
  for (const auto& [path, given_value] : overrides)
    if (const PointKey* key = findPointKey(path); key && key->read) key->read(given_value.place(), settings);
  settings.sceneName = scene.name;
  if (settings.shading.shadows && !given.find("pictures.reference")) settings.pictures.reference = "none";
  checkTechnique(given, technique, settings);
  checkCombination(given, settings);
  return settings;
}

Point pointOf(PointSettings settings) {
  Point point;
  point.config = writePoint(settings);
  // The point may have changed what its scene generates.
  settings.scene.document["volume"] = point.config["volume"];
  point.labels = {{"technique", settings.technique}};
  nlohmann::json shared = point.config;
  shared.erase("technique");
  const std::string text = shared.dump();
  point.group = fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
  point.settings = std::move(settings);
  return point;
}

PointSettings readPoint(const nlohmann::json& config, const std::string& file, const TechniqueCatalogue& techniques,
                        const std::filesystem::path& scenesFolder) {
  const JsonValue place(config, file);
  SceneLibrary scenes(scenesFolder);
  Overrides overrides;
  applyOverrides(readOverrides(place), overrides);
  return readSettings(overrides, place, techniques, scenes);
}

Point makePoint(const nlohmann::json& set, const std::vector<std::string>& assignments,
                const TechniqueCatalogue& techniques, const std::filesystem::path& scenesFolder) {
  const JsonValue place(set, "command line");
  SceneLibrary scenes(scenesFolder);
  Overrides overrides;
  applyOverrides(readOverrides(place), overrides);
  for (const std::string& text : assignments) {
    const Assignment assignment = parseAssignment(text);
    const nlohmann::json one = {{assignment.path, nlohmann::json(assignment.value)}};
    applyOverrides(readOverrides(JsonValue(one, assignment.place)), overrides);
  }
  return pointOf(readSettings(overrides, place, techniques, scenes));
}

} // namespace volmark
