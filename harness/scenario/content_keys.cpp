#include "scenario/key_makers.h"
#include "volmark/parameters.h"

#include <fmt/format.h>

namespace volmark {

namespace {

using namespace keys;

constexpr const char* kOfScene = "the scene's";
constexpr const char* kFirstOfScene = "the scene's first";

// --- Scene and volume ----------------------------------------------------------------------------------------

PointKey scene() {
  return derived(plain(
                     "scene", "", "Name of a file in the scenes folder, or a path to a scene file or NRRD volume.",
                     {{"type", "string"}, {"minLength", 1}},
                     [](const JsonValue& value, PointSettings& s) { s.sceneName = value.text(); },
                     [](const PointSettings& s) { return nlohmann::json(s.sceneName); }),
                 "none: it has to be given");
}

bool isGenerated(const PointSettings& s) {
  return std::holds_alternative<GeneratorSource>(s.scene.source);
}

/// A setting of the scene's generator; the scene decides whether there is one.
template <class Read, class Write>
PointKey generatorKey(const std::string& name, std::string unit, std::string documentation, nlohmann::json schema,
                      Read readValue, Write writeValue) {
  PointKey key = plain(
      "volume.generator." + name, std::move(unit), std::move(documentation), std::move(schema),
      [=](const JsonValue& value, PointSettings& s) {
        auto* source = std::get_if<GeneratorSource>(&s.scene.source);
        if (!source) value.fail(fmt::format("the volume of scene \"{}\" is a file, not generated", s.scene.name));
        readValue(value, source->settings);
      },
      [=](const PointSettings& s) { return writeValue(std::get<GeneratorSource>(s.scene.source).settings); });
  return onlyIf(isGenerated, derived(std::move(key), kOfScene));
}

void readDims(const JsonValue& value, GeneratorSettings& g) {
  const std::vector<JsonValue> sides = value.array();
  if (sides.size() != 3) value.refuse("[x, y, z], each integer 1 to 4096");
  for (int i = 0; i < 3; ++i)
    g.dims[i] = static_cast<int>(sides[static_cast<std::size_t>(i)].integer(1, 4096));
}

void readSpacing(const JsonValue& value, GeneratorSettings& g) {
  g.spacingMm = vectorFrom(value, 1e-6, 1e6);
}

void readType(const JsonValue& value, GeneratorSettings& g) {
  g.type = scalarTypeFromName(value.choice({"int8", "uint8", "int16", "uint16", "float32"}));
}

void readGeneratorParameters(const JsonValue& value, GeneratorSettings& g) {
  JsonObject object(value);
  for (const auto& [name, ignored] : value.json().items())
    g.parameters[name] = value.member(name).number(-1e9, 1e9);
}

void readGeneratorName(const JsonValue& value, GeneratorSettings& g) {
  if (value.text() != g.name && !g.name.empty()) value.refuse(fmt::format("\"{}\", as in the scene file", g.name));
}

std::vector<PointKey> generatorKeys() {
  const nlohmann::json side = {{"type", "integer"}, {"minimum", 1}, {"maximum", 4096}};
  return {
      generatorKey("name", "", "The generator of the scene's volume; can't be changed.", {{"type", "string"}},
                   readGeneratorName, [](const GeneratorSettings& g) { return nlohmann::json(g.name); }),
      generatorKey("dims", "voxels", "Size of a generated volume.",
                   {{"type", "array"}, {"items", side}, {"minItems", 3}, {"maxItems", 3}}, readDims,
                   [](const GeneratorSettings& g) {
                     return nlohmann::json{g.dims.x, g.dims.y, g.dims.z};
                   }),
      generatorKey("spacing_mm", "mm", "Voxel spacing of a generated volume.", vectorSchema(1e-6, 1e6), readSpacing,
                   [](const GeneratorSettings& g) { return toJson(g.spacingMm); }),
      generatorKey("type", "", "Scalar type of a generated volume.",
                   {{"enum", {"int8", "uint8", "int16", "uint16", "float32"}}}, readType,
                   [](const GeneratorSettings& g) { return nlohmann::json(std::string(nameOf(g.type))); }),
      generatorKey("parameters", "", "Numbers of the generator by name; the others stay as in the scene.",
                   {{"type", "object"}, {"additionalProperties", {{"type", "number"}}}}, readGeneratorParameters,
                   [](const GeneratorSettings& g) {
                     nlohmann::json result = nlohmann::json::object();
                     for (const auto& [name, value] : g.parameters)
                       result[name] = canonical(value);
                     return result;
                   }),
  };
}

/// What a file volume is: shown in the resolved configuration, but only the scene file can change it.
template <class Source, class Write>
PointKey fixedVolumeKey(const std::string& name, std::string documentation, Write writeValue) {
  PointKey key = plain(
      "volume." + name, "", std::move(documentation), nlohmann::json::object(),
      [=](const JsonValue& value, PointSettings& s) {
        const auto* source = std::get_if<Source>(&s.scene.source);
        if (!source || writeValue(*source) != value.json())
          value.fail(fmt::format("the volume of scene \"{}\" can only be changed in the scene file", s.scene.name));
      },
      [=](const PointSettings& s) { return writeValue(std::get<Source>(s.scene.source)); });
  key.check = [](const JsonValue&) {};
  return onlyIf([](const PointSettings& s) { return std::holds_alternative<Source>(s.scene.source); },
                derived(std::move(key), kOfScene));
}

nlohmann::json writeRaw(const RawSource& source) {
  const RawDescription& raw = source.description;
  return {{"file", source.file},
          {"dims", {raw.grid.dims.x, raw.grid.dims.y, raw.grid.dims.z}},
          {"type", std::string(nameOf(raw.type))},
          {"spacing_mm", toJson(raw.grid.spacingMm)},
          {"endian", raw.bigEndian ? "big" : "little"},
          {"offset_bytes", raw.offsetBytes},
          {"time_steps", raw.timeSteps}};
}

PointKey visualisationRange() {
  PointKey key = plain(
      "visualisation_range", "", "Data values that become 0 and 1; data: the smallest and largest voxel.",
      {{"anyOf",
        {{{"const", "data"}}, {{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 2}, {"maxItems", 2}}}}},
      [](const JsonValue& value, PointSettings& s) {
        if (value.json() == "data") {
          s.scene.visualisationRange.reset();
          return;
        }
        if (!value.json().is_array()) value.refuse("\"data\" or [smallest, largest]");
        const std::vector<double> range = value.numbers(2, -1e30, 1e30);
        if (range[0] >= range[1]) value.refuse("[smallest, largest] with smallest < largest");
        s.scene.visualisationRange = Range{range[0], range[1]};
      },
      [](const PointSettings& s) {
        const auto& range = s.scene.visualisationRange;
        return range ? nlohmann::json{canonical(range->minimum), canonical(range->maximum)} : nlohmann::json("data");
      });
  return derived(std::move(key), kOfScene);
}

// --- Technique -----------------------------------------------------------------------------------------------

PointKey techniqueName() {
  return derived(plain(
                     "technique.name", "", "Name of a technique (volmark describe lists them).",
                     {{"type", "string"}, {"minLength", 1}},
                     [](const JsonValue& value, PointSettings& s) { s.technique = value.text(); },
                     [](const PointSettings& s) { return nlohmann::json(s.technique); }),
                 "none: it has to be given");
}

PointKey techniqueParameters() {
  PointKey key;
  key.path = "technique.parameters";
  key.documentation = "Values of the technique's own parameters by name.";
  key.schema = {{"type", "object"}, {"additionalProperties", {{"type", {"boolean", "number", "string"}}}}};
  key.derivedDefault = "the technique's";
  key.open = true;
  key.check = [](const JsonValue& value) {
    const nlohmann::json& json = value.json();
    if (json.is_structured() || json.is_null()) value.refuse("true or false, number or text");
  };
  key.write = [](const PointSettings& s) {
    nlohmann::json result = nlohmann::json::object();
    for (const ParameterDescriptor& descriptor : s.parameters.descriptors())
      std::visit([&](const auto& v) { result[descriptor.name] = v; }, s.parameters.value(descriptor.name));
    return result;
  };
  return key;
}

// --- Isovalue and transfer function --------------------------------------------------------------------------

PointKey isovalue() {
  PointKey key = plain(
      "isovalue", "", "Normalised, raw (the data's unit) or the name of one of the scene's.", isovalueSchema(),
      [](const JsonValue& value, PointSettings& s) { s.isovalue = resolveIsovalue(value, s.scene); },
      [](const PointSettings& s) { return s.isovalue ? toJson(*s.isovalue) : nlohmann::json(); });
  key.check = checkIsovalue;
  return derived(std::move(key), kFirstOfScene);
}

bool bySpot(const PointSettings& s) {
  return s.light.isSpot();
}

PointKey hiddenSegments() {
  return onlyIf(
      [](const PointSettings& s) { return s.scene.labels.has_value(); },
      plain(
          "hidden_segments", "", "Labels of the scene's segments that are not drawn.",
          {{"type", "array"}, {"items", {{"type", "integer"}, {"minimum", 0}, {"maximum", kMaximumSegments - 1}}}},
          [](const JsonValue& value, PointSettings& s) {
            s.hiddenSegments.reset();
            for (const JsonValue& label : value.array())
              s.hiddenSegments.set(static_cast<std::size_t>(label.integer(0, kMaximumSegments - 1)));
          },
          [](const PointSettings& s) {
            nlohmann::json labels = nlohmann::json::array();
            for (std::size_t label = 0; label < s.hiddenSegments.size(); ++label)
              if (s.hiddenSegments[label]) labels.push_back(label);
            return labels;
          }));
}

PointKey functionBeyond() {
  nlohmann::json schema = transferFunctionSchema();
  schema["anyOf"].push_back({{"type", "null"}});
  PointKey key = plain(
      "transfer_function_beyond", "",
      "Draws what clipping planes cut off: control points, or a name of the scene's; null: it is not drawn.", schema,
      [](const JsonValue& value, PointSettings& s) {
        if (value.json().is_null())
          s.functionBeyond.reset();
        else
          s.functionBeyond = resolveTransferFunction(value, s.scene);
      },
      [](const PointSettings& s) { return s.functionBeyond ? toJson(*s.functionBeyond) : nlohmann::json(); });
  key.check = [](const JsonValue& value) {
    if (!value.json().is_null()) checkTransferFunction(value);
  };
  return onlyIf([](const PointSettings& s) { return !s.timeline.clippingPlanes.empty(); }, std::move(key));
}

PointKey transferFunction() {
  PointKey key = plain(
      "transfer_function", "", "Control points, or the name of one of the scene's.", transferFunctionSchema(),
      [](const JsonValue& value, PointSettings& s) { s.transferFunction = resolveTransferFunction(value, s.scene); },
      [](const PointSettings& s) { return toJson(*s.transferFunction); });
  key.check = checkTransferFunction;
  return derived(std::move(key), kFirstOfScene);
}

} // namespace

std::vector<PointKey> contentKeys() {
  std::vector<PointKey> result = {scene()};
  for (PointKey& key : generatorKeys())
    result.push_back(std::move(key));
  result.push_back(fixedVolumeKey<FileSource>("file", "The scene's volume file; can't be changed.",
                                              [](const FileSource& f) { return nlohmann::json(f.file); }));
  result.push_back(fixedVolumeKey<RawSource>("raw", "The scene's headerless volume; can't be changed.", writeRaw));
  result.push_back(visualisationRange());
  result.push_back(derived(
      direction(
          "framing.up", [](auto& s) -> auto& { return s.scene.framing.up; }, "Axis of the orbit in the volume's axes."),
      kOfScene));
  result.push_back(derived(direction(
                               "framing.front", [](auto& s) -> auto& { return s.scene.framing.front; },
                               "From the centre to the camera at azimuth 0; orthogonal to up."),
                           kOfScene));
  result.push_back(techniqueName());
  result.push_back(techniqueParameters());
  result.push_back(isovalue());
  result.push_back(transferFunction());
  result.push_back(functionBeyond());
  result.push_back(hiddenSegments());
  result.push_back(derived(choice(
                               "shading.model", [](auto& s) -> auto& { return s.shading.model; },
                               std::vector<std::pair<std::string, ShadingModel>>{{"none", ShadingModel::none},
                                                                                 {"lambert", ShadingModel::lambert},
                                                                                 {"phong", ShadingModel::phong},
                                                                                 {"gooch", ShadingModel::gooch},
                                                                                 {"ggx", ShadingModel::ggx}},
                               "How surfaces and shaded samples are lit."),
                           "the technique's first"));
  result.push_back(vector(
      "shading.surface_color", [](auto& s) -> auto& { return s.shading.surfaceColor; }, 0, 1,
      "Colour of isosurfaces, linear Rec.709."));
  result.push_back(onlyIf(bySpot, boolean(
                                      "shading.shadows", [](auto& s) -> auto& { return s.shading.shadows; },
                                      "The volume keeps the spotlight's light from itself.")));
  result.push_back(derived(
      boolean(
          "light.headlight", [](auto& s) -> auto& { return s.light.headlight; }, "The light comes from the eye."),
      kOfScene));
  result.push_back(onlyIf([](const PointSettings& s) { return !s.light.headlight; },
                          derived(direction(
                                      "light.direction", [](auto& s) -> auto& { return s.light.direction; },
                                      "Towards the light, in the volume's axes."),
                                  kOfScene)));
  result.push_back(onlyIf([](const PointSettings& s) { return !s.light.headlight; },
                          derived(boolean(
                                      "light.spot", [](auto& s) -> auto& { return s.light.spot; },
                                      "A spotlight on the whole volume instead of a light infinitely far away."),
                                  kOfScene)));
  result.push_back(
      onlyIf(bySpot, derived(number(
                                 "light.distance", [](auto& s) -> auto& { return s.light.distance; }, 1.1, 100,
                                 "radius", "From the volume's centre to the spotlight; its bounding sphere is 1."),
                             kOfScene)));
  result.push_back(derived(vector(
                               "light.color", [](auto& s) -> auto& { return s.light.color; }, 0, 100,
                               "Colour of the light, linear Rec.709."),
                           kOfScene));
  result.push_back(derived(number(
                               "light.ambient", [](auto& s) -> auto& { return s.light.ambient; }, 0, 1, "",
                               "Share of the colour that needs no light."),
                           kOfScene));
  return result;
}

} // namespace volmark
