#include "scenario/scene_file.h"

#include "volmark/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace volmark {

namespace {

constexpr double kAnyNumber = 1e30;
constexpr double kSmallestSpacing = 1e-6;
constexpr double kLargestSpacing = 1e6;
constexpr std::int64_t kLargestDimension = 65536;
constexpr std::int64_t kLargestGeneratedDimension = 4096;
const std::vector<std::string> kTypeNames = {"int8", "uint8", "int16", "uint16", "float32"};

glm::dvec3 vectorOf(const JsonValue& value, double minimum, double maximum) {
  const std::vector<double> numbers = value.numbers(3, minimum, maximum);
  return {numbers[0], numbers[1], numbers[2]};
}

glm::dvec3 directionOf(const JsonValue& value) {
  const glm::dvec3 vector = vectorOf(value, -1e6, 1e6);
  if (glm::length(vector) < 1e-6) value.refuse("a vector with a direction");
  return glm::normalize(vector);
}

glm::ivec3 dimsOf(const JsonValue& value, std::int64_t largest) {
  const std::vector<JsonValue> sides = value.array();
  if (sides.size() != 3) value.refuse(fmt::format("[x, y, z], each integer 1 to {}", largest));
  glm::ivec3 dims;
  for (int axis = 0; axis < 3; ++axis)
    dims[axis] = static_cast<int>(sides[static_cast<std::size_t>(axis)].integer(1, largest));
  return dims;
}

/// Keys of an object in file order, which parsing to nlohmann::json loses.
std::vector<std::string> keysInOrder(const nlohmann::ordered_json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, ignored] : object.items())
    keys.push_back(key);
  return keys;
}

TransferFunction defaultTransferFunction() {
  return TransferFunction("ramp", {{0, glm::dvec3(0.0), 0}, {1, glm::dvec3(1.0), 0.5}});
}

std::pair<std::string, Isovalue> defaultIsovalue() {
  return {"middle", Isovalue{false, 0.5}};
}

// --- Volume --------------------------------------------------------------------------------------------------

GeneratorSource parseGenerator(const JsonValue& value) {
  JsonObject object(value);
  GeneratorSource source;
  GeneratorSettings& settings = source.settings;
  settings.name = object.at("name").choice(generatorNames());
  settings.dims = dimsOf(object.at("dims"), kLargestGeneratedDimension);
  if (const auto spacing = object.find("spacing_mm"))
    settings.spacingMm = vectorOf(*spacing, kSmallestSpacing, kLargestSpacing);
  if (const auto type = object.find("type")) settings.type = scalarTypeFromName(type->choice(kTypeNames));
  if (const auto parameters = object.find("parameters")) {
    const JsonObject isObject(*parameters);
    for (const auto& [name, ignored] : parameters->json().items())
      settings.parameters[name] = parameters->member(name).number(-kAnyNumber, kAnyNumber);
    try {
      checkGenerator(settings);
    } catch (const InputError& error) {
      parameters->fail(error.what());
    }
  }
  object.refuseOthers();
  return source;
}

/// What must be known of any file without a header.
RawDescription parseLayout(JsonObject& object) {
  RawDescription raw;
  raw.grid.dims = dimsOf(object.at("dims"), kLargestDimension);
  raw.type = scalarTypeFromName(object.at("type").choice(kTypeNames));
  if (const auto spacing = object.find("spacing_mm"))
    raw.grid.spacingMm = vectorOf(*spacing, kSmallestSpacing, kLargestSpacing);
  return raw;
}

RawSource parseRaw(const JsonValue& value) {
  JsonObject object(value);
  RawSource source;
  source.file = object.at("file").text();
  source.description = parseLayout(object);
  RawDescription& raw = source.description;
  if (const auto endian = object.find("endian")) raw.bigEndian = endian->choice({"little", "big"}) == "big";
  if (const auto offset = object.find("offset_bytes"))
    raw.offsetBytes = static_cast<std::uint64_t>(offset->integer(0, std::int64_t(1) << 40));
  if (const auto steps = object.find("time_steps")) raw.timeSteps = static_cast<int>(steps->integer(1, 1'000'000));
  object.refuseOthers();
  return source;
}

SeriesSource parseSeries(const JsonValue& value) {
  SeriesSource source;
  for (const JsonValue& file : value.array())
    source.files.push_back(file.text());
  if (source.files.empty()) value.refuse("at least one file name");
  return source;
}

MeshSource parseMesh(const JsonValue& value) {
  JsonObject object(value);
  MeshSource source;
  source.file = object.at("file").text();
  if (const auto voxels = object.find("voxels"))
    source.settings.voxels = static_cast<int>(voxels->integer(16, kLargestGeneratedDimension));
  if (const auto band = object.find("band_voxels"))
    source.settings.bandVoxels = static_cast<int>(band->integer(3, 1000));
  object.refuseOthers();
  return source;
}

void parseVolume(const JsonValue& value, SceneDescription& scene) {
  JsonObject object(value);
  const auto file = object.find("file");
  const auto files = object.find("files");
  const auto raw = object.find("raw");
  const auto mesh = object.find("mesh");
  const auto generator = object.find("generator");
  object.refuseOthers();
  const int given = int(file.has_value()) + int(files.has_value()) + int(raw.has_value()) + int(mesh.has_value()) +
                    int(generator.has_value());
  if (given != 1) value.refuse("exactly one of \"file\", \"files\", \"raw\", \"mesh\", \"generator\"");
  if (file) scene.source = FileSource{file->text()};
  if (files) scene.source = parseSeries(*files);
  if (mesh) scene.source = parseMesh(*mesh);
  if (raw) scene.source = parseRaw(*raw);
  if (generator) scene.source = parseGenerator(*generator);
}

LabelsSource parseLabels(const JsonValue& value, const SceneDescription& scene) {
  JsonObject object(value);
  const auto file = object.find("file");
  const auto generator = object.find("generator");
  object.refuseOthers();
  if (file.has_value() == generator.has_value()) value.refuse("one of \"file\" and \"generator\"");
  if (file) return {.file = file->text()};
  const auto* source = std::get_if<GeneratorSource>(&scene.source);
  if (!source) generator->fail("only the labels of a generated volume can be generated");
  GeneratorSettings settings = source->settings;
  settings.name = generator->choice(generatorNames());
  settings.type = ScalarType::uint8;
  try {
    checkGenerator(settings);
  } catch (const InputError& error) {
    generator->fail(error.what());
  }
  return {.generator = settings.name};
}

/// scenes/fetch.py is who uses it all.
void parseSource(const JsonValue& value, SceneDescription& scene) {
  JsonObject object(value);
  const auto package = object.find("package");
  const auto packageFile = object.find("package_file");
  const auto packageMember = object.find("package_member");
  const auto url = object.find("url");
  const auto raw = object.find("raw");
  const auto license = object.find("license");
  const auto sha512 = object.find("sha512");
  for (const char* name : {"acknowledgement", "note"})
    if (const auto text = object.find(name)) text->text();
  object.refuseOthers();

  if (license) scene.license = license->text();
  if (url) url->text();
  if (raw) {
    if (!url) value.fail("\"raw\" describes the file at \"url\", which is missing");
    JsonObject layout(*raw);
    parseLayout(layout);
    layout.refuseOthers();
  }
  if (package.has_value() != packageFile.has_value()) value.refuse("\"package\" and \"package_file\", or neither");
  if (package) package->text();
  if (packageMember && !package) packageMember->refuse("nothing without \"package\"");
  if (packageMember) packageMember->text();
  if (packageFile && !packageFile->text().starts_with('/')) packageFile->refuse("an absolute path");
  if (package || url) scene.fetchHint = fmt::format("scenes/fetch.py {}", scene.name);
  if (sha512) {
    const std::string digits = sha512->text();
    if (digits.size() != 128 || digits.find_first_not_of("0123456789abcdef") != std::string::npos)
      sha512->refuse("128 hexadecimal digits in lower case");
  }
}

// --- How it is looked at -------------------------------------------------------------------------------------

void parseFraming(const JsonValue& value, Framing& framing) {
  JsonObject object(value);
  framing.up = directionOf(object.at("up"));
  framing.front = directionOf(object.at("front"));
  object.refuseOthers();
  if (std::abs(glm::dot(framing.up, framing.front)) > 1e-6) value.refuse("\"front\" orthogonal to \"up\"");
}

Range parseRange(const JsonValue& value) {
  const std::vector<double> numbers = value.numbers(2, -kAnyNumber, kAnyNumber);
  if (numbers[0] >= numbers[1]) value.refuse("[smallest, largest] with smallest < largest");
  return {numbers[0], numbers[1]};
}

/// The named entries of an object, in file order; at least one.
template <class Parse> void parseNamed(const JsonValue& value, const nlohmann::ordered_json& ordered, Parse parse) {
  const JsonObject isObject(value);
  const std::vector<std::string> names = keysInOrder(ordered);
  if (names.empty()) value.refuse("at least one");
  for (const std::string& name : names) {
    if (name.empty()) value.refuse("names that are not empty");
    parse(name, value.member(name));
  }
}

} // namespace

Isovalue parseIsovalue(const JsonValue& value) {
  JsonObject object(value);
  const auto normalized = object.find("normalized");
  const auto raw = object.find("raw");
  object.refuseOthers();
  if (normalized.has_value() == raw.has_value()) value.refuse("{\"normalized\": 0 to 1} or {\"raw\": number}");
  if (normalized) return {false, normalized->number(0, 1)};
  return {true, raw->number(-kAnyNumber, kAnyNumber)};
}

TransferFunction parseTransferFunction(const std::string& name, const JsonValue& value) {
  JsonObject object(value);
  const JsonValue list = object.at("points");
  object.refuseOthers();
  std::vector<ControlPoint> points;
  for (const JsonValue& element : list.array()) {
    JsonObject point(element);
    const JsonValue position = point.at("value");
    points.push_back({.value = position.number(0, 1),
                      .color = vectorOf(point.at("color"), 0, 1),
                      .opacity = point.at("opacity").number(0, 1)});
    point.refuseOthers();
    if (points.size() > 1 && points.back().value < points[points.size() - 2].value)
      position.refuse(fmt::format("at least {}, the value of the point before", points[points.size() - 2].value));
  }
  if (points.empty()) list.refuse("at least one point");
  return TransferFunction(name, std::move(points));
}

Light parseLight(const JsonValue& value) {
  JsonObject object(value);
  Light light;
  const auto direction = object.find("direction");
  if (direction) light.direction = directionOf(*direction);
  // Who gives a direction and nothing else means it.
  light.headlight = !direction;
  if (const auto headlight = object.find("headlight")) light.headlight = headlight->boolean();
  if (const auto spot = object.find("spot")) light.spot = spot->boolean();
  if (const auto distance = object.find("distance")) light.distance = distance->number(1.1, 100);
  if (const auto color = object.find("color")) light.color = vectorOf(*color, 0, 100);
  if (const auto ambient = object.find("ambient")) light.ambient = ambient->number(0, 1);
  object.refuseOthers();
  if (light.spot && light.headlight) value.fail("a spotlight needs a \"direction\" and no headlight");
  if (!light.headlight && !direction) value.fail("key \"direction\" is missing, without a headlight it is needed");
  return light;
}

SceneDescription readScene(const std::filesystem::path& path) {
  const nlohmann::ordered_json ordered = readOrderedJsonFile(path);
  SceneDescription scene;
  scene.name = path.stem().string();
  scene.path = path;
  scene.document = nlohmann::json(ordered);

  const JsonValue root(scene.document, path.string());
  JsonObject object(root);
  object.at("volmark_scene").integer(1, 1);
  scene.title = object.at("title").text();
  parseVolume(object.at("volume"), scene);
  if (const auto labels = object.find("labels")) scene.labels = parseLabels(*labels, scene);
  if (const auto source = object.find("source")) parseSource(*source, scene);
  if (const auto range = object.find("visualisation_range")) scene.visualisationRange = parseRange(*range);
  if (const auto isovalues = object.find("isovalues"))
    parseNamed(*isovalues, ordered["isovalues"], [&](const std::string& name, const JsonValue& value) {
      scene.isovalues.emplace_back(name, parseIsovalue(value));
    });
  if (const auto functions = object.find("transfer_functions"))
    parseNamed(*functions, ordered["transfer_functions"], [&](const std::string& name, const JsonValue& value) {
      scene.transferFunctions.emplace_back(name, parseTransferFunction(name, value));
    });
  if (const auto framing = object.find("framing")) parseFraming(*framing, scene.framing);
  if (const auto light = object.find("light")) scene.light = parseLight(*light);
  object.refuseOthers();

  if (scene.isovalues.empty()) scene.isovalues.push_back(defaultIsovalue());
  if (scene.transferFunctions.empty()) scene.transferFunctions.emplace_back("ramp", defaultTransferFunction());
  return scene;
}

SceneDescription sceneForFile(const std::filesystem::path& path) {
  // "series/", as shells complete a folder's name.
  const std::filesystem::path volume = path.has_filename() ? path : path.parent_path();
  SceneDescription scene;
  scene.name = volume.stem().string();
  scene.title = volume.filename().string();
  scene.source = FileSource{volume.string()};
  scene.isovalues.push_back(defaultIsovalue());
  scene.transferFunctions.emplace_back("ramp", defaultTransferFunction());
  scene.document = {{"volmark_scene", 1}, {"title", scene.title}, {"volume", {{"file", volume.string()}}}};
  return scene;
}

} // namespace volmark
