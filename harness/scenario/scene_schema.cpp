#include "scenario/key_makers.h"
#include "scenario/scenario.h"

#include <nlohmann/json.hpp>

namespace volmark {

namespace {

using nlohmann::json;

json schemaOf(const std::string& path) {
  json schema = findPointKey(path)->schema;
  schema["description"] = findPointKey(path)->documentation;
  return schema;
}

json object(json properties, const std::vector<std::string>& required) {
  return {{"type", "object"},
          {"properties", std::move(properties)},
          {"required", required},
          {"additionalProperties", false}};
}

/// What must be known of any file without a header.
json layoutSchema() {
  json layout = object({{"dims", schemaOf("volume.generator.dims")},
                        {"type", schemaOf("volume.generator.type")},
                        {"spacing_mm", schemaOf("volume.generator.spacing_mm")}},
                       {"dims", "type"});
  // One voxel along an axis is a volume too, if it comes from a file.
  layout["properties"]["dims"]["items"] = {{"type", "integer"}, {"minimum", 1}};
  layout["properties"]["dims"]["description"] = "Voxels along x, y, z.";
  layout["properties"]["type"]["description"] = "Scalar type.";
  layout["properties"]["spacing_mm"]["description"] = "Distance of voxel centres.";
  return layout;
}

/// One alternative for each generator, with its parameters.
json generatorSchema() {
  json alternatives = json::array();
  for (const std::string& name : generatorNames()) {
    json parameters = json::object();
    for (const ParameterDescriptor& parameter : generatorParameters(name))
      parameters[parameter.name] = keys::parameterSchema(parameter);
    alternatives.push_back(object({{"name", {{"const", name}}},
                                   {"dims", schemaOf("volume.generator.dims")},
                                   {"spacing_mm", schemaOf("volume.generator.spacing_mm")},
                                   {"type", schemaOf("volume.generator.type")},
                                   {"parameters", object(parameters, {})}},
                                  {"name", "dims"}));
  }
  return {{"oneOf", alternatives}};
}

json volumeSchema() {
  const json text = {{"type", "string"}, {"minLength", 1}};
  json raw = layoutSchema();
  raw["properties"]["file"] = text;
  raw["properties"]["endian"] = {{"enum", {"little", "big"}}};
  raw["properties"]["offset_bytes"] = {{"type", "integer"}, {"minimum", 0}};
  raw["properties"]["time_steps"] = {{"type", "integer"}, {"minimum", 1}};
  raw["required"].push_back("file");
  const json files = {{"type", "array"},
                      {"items", text},
                      {"minItems", 1},
                      {"description", "One file per time step; * stands for several, in natural order."}};
  json mesh = object({{"file", text},
                      {"voxels", {{"type", "integer"}, {"minimum", 16}, {"maximum", 4096}}},
                      {"band_voxels", {{"type", "integer"}, {"minimum", 3}, {"maximum", 1000}}}},
                     {"file"});
  mesh["description"] = "Signed distance to a closed mesh (OFF), mm, positive inside: voxels along the longest side "
                        "(default 256), clamped to band_voxels (default 16).";
  return {{"oneOf",
           {object({{"file", text}}, {"file"}), object({{"files", files}}, {"files"}), object({{"raw", raw}}, {"raw"}),
            object({{"mesh", mesh}}, {"mesh"}), object({{"generator", generatorSchema()}}, {"generator"})}}};
}

json labelsSchema() {
  const json text = {{"type", "string"}, {"minLength", 1}};
  return {{"description",
           "Segments of the voxels, uint8 below 128: a file, or a generator that takes the volume's settings."},
          {"oneOf",
           {object({{"file", text}}, {"file"}), object({{"generator", {{"enum", generatorNames()}}}}, {"generator"})}}};
}

json sourceSchema() {
  json properties = json::object();
  for (const char* key : {"package", "package_member", "url", "license", "acknowledgement", "note"})
    properties[key] = {{"type", "string"}, {"minLength", 1}};
  properties["package_file"] = {{"type", "string"}, {"pattern", "^/"}};
  properties["raw"] = layoutSchema();
  properties["raw"]["description"] = "Of the file at \"url\" if it has no header; little-endian.";
  properties["sha512"] = {{"type", "string"}, {"pattern", "^[0-9a-f]{128}$"}};
  json schema = object(properties, {});
  schema["dependentRequired"] = {{"package", json::array({"package_file"})},
                                 {"package_file", json::array({"package"})},
                                 {"package_member", json::array({"package"})},
                                 {"raw", json::array({"url"})}};
  schema["description"] = "Where the data comes from.";
  return schema;
}

/// Of alternatives, those that are no names in a scene.
json withoutNames(const json& schema) {
  json result = json::array();
  for (const json& alternative : schema["anyOf"])
    if (alternative.value("type", "") != "string") result.push_back(alternative);
  return {{"anyOf", result}};
}

} // namespace

json sceneSchema() {
  const json text = {{"type", "string"}, {"minLength", 1}};
  const json byName = {{"type", "object"}, {"minProperties", 1}};
  json isovalues = byName;
  isovalues["additionalProperties"] = withoutNames(findPointKey("isovalue")->schema);
  json transferFunctions = byName;
  transferFunctions["additionalProperties"] = withoutNames(findPointKey("transfer_function")->schema);

  json range = findPointKey("visualisation_range")->schema["anyOf"][1];
  range["description"] = "Data values that become 0 and 1; default: the smallest and largest voxel.";
  json schema = object(
      {{"$schema", text},
       {"volmark_scene", {{"const", 1}, {"description", "Version of the format."}}},
       {"title", text},
       {"volume", volumeSchema()},
       {"labels", labelsSchema()},
       {"source", sourceSchema()},
       {"visualisation_range", range},
       {"isovalues", isovalues},
       {"transfer_functions", transferFunctions},
       {"framing", object({{"up", schemaOf("framing.up")}, {"front", schemaOf("framing.front")}}, {"up", "front"})},
       {"light", object({{"headlight", schemaOf("light.headlight")},
                         {"direction", schemaOf("light.direction")},
                         {"spot", schemaOf("light.spot")},
                         {"distance", schemaOf("light.distance")},
                         {"color", schemaOf("light.color")},
                         {"ambient", schemaOf("light.ambient")}},
                        {})}},
      {"volmark_scene", "title", "volume"});
  schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  schema["title"] = "volmark scene, version 1";
  return schema;
}

} // namespace volmark
