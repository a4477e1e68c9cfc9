// JSON Schemas for editors, made from the table of point keys and the catalogue. The reader stays the judge.
#include "scenario/key_makers.h"
#include "scenario/scenario.h"

#include <fmt/format.h>

namespace volmark {

namespace {

using nlohmann::json;

constexpr const char* kDraft = "https://json-schema.org/draft/2020-12/schema";

json closedObject(json properties) {
  return {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
}

json orNull(json schema) {
  return {{"anyOf", json::array({std::move(schema), {{"type", "null"}}})}};
}

json documented(const PointKey& key) {
  json schema = key.schema;
  schema["description"] = key.documentation + (key.unit.empty() ? "" : fmt::format(" Unit: {}.", key.unit)) +
                          (key.derivedDefault.empty() ? "" : fmt::format(" Default: {}.", key.derivedDefault));
  if (key.derivedDefault.empty()) schema["default"] = key.defaultValue();
  return schema;
}

/// The keys of a point as nested objects: what "set" takes besides dotted paths.
json nestedProperties() {
  json root = json::object();
  for (const PointKey& key : pointKeys()) {
    json* properties = &root;
    std::string rest = key.path;
    for (std::size_t dot; (dot = rest.find('.')) != std::string::npos; rest.erase(0, dot + 1)) {
      json& group = (*properties)[rest.substr(0, dot)];
      if (group.is_null()) {
        group = closedObject(json::object());
        group["type"] = {"object", "null"}; // null forgets the whole group
      }
      properties = &group["properties"];
    }
    (*properties)[rest] = orNull(documented(key));
  }
  return root;
}

json dottedProperties() {
  json properties = json::object();
  for (const PointKey& key : pointKeys())
    if (key.path.find('.') != std::string::npos) properties[key.path] = orNull(documented(key));
  return properties;
}

/// Parts of groups given dotted: {"volume.generator": {"dims": ...}}.
void addGroups(const json& nested, const std::string& prefix, json& properties) {
  for (const auto& [name, schema] : nested.items()) {
    const std::string path = prefix + name;
    if (!schema.contains("properties")) continue;
    if (!properties.contains(path)) properties[path] = schema;
    addGroups(schema["properties"], path + ".", properties);
  }
}

json setSchema() {
  json properties = nestedProperties();
  const json nested = properties;
  properties.update(dottedProperties());
  addGroups(nested, "", properties);
  json schema = closedObject(std::move(properties));
  for (const PointKey& key : pointKeys())
    if (key.open)
      schema["patternProperties"]["^" + key.path + "\\.[a-z0-9_]+$"] =
          orNull({{"type", {"boolean", "number", "string"}}});
  return schema;
}

json limitsSchema() {
  const json count = {{"type", {"integer", "null"}}, {"minimum", 1}};
  return closedObject({{"pixels", count}, {"voxels", count}, {"frames", count}});
}

json sampleSchema() {
  json sample = closedObject({{"count", {{"type", "integer"}, {"minimum", 1}, {"maximum", 100000}}},
                              {"seed", {{"type", "integer"}, {"minimum", 0}, {"maximum", 0xffffffff}}}});
  sample["required"] = {"count"};
  sample["description"] = "Random points of the grid instead of all.";
  return sample;
}

json exclusionsSchema() {
  const json entry = {{"type", "object"}, {"minProperties", 1}};
  return {{"type", "array"},
          {"items", entry},
          {"description", "Combinations to leave out: values, or lists of values, by axis."}};
}

json axisSchema() {
  const json labelled = {
      {"type", "object"},
      {"properties", {{"label", {{"type", "string"}, {"minLength", 1}}}, {"set", {{"$ref", "#/$defs/set"}}}}},
      {"required", {"label", "set"}},
      {"additionalProperties", false}};
  json axis = closedObject(
      {{"path", {{"type", "string"}, {"minLength", 1}}}, {"values", {{"type", "array"}, {"minItems", 1}}}});
  axis["required"] = {"values"};
  axis["if"] = {{"required", {"path"}}};
  axis["then"] = json::object();
  axis["else"] = {{"properties", {{"values", {{"items", labelled}}}}}};
  return axis;
}

/// What a set may say about the parameters of one technique.
json parametersOf(const json& parameters) {
  json dotted = json::object();
  for (const auto& [name, schema] : parameters["properties"].items())
    dotted["technique.parameters." + name] = orNull(schema);
  dotted["technique.parameters"] = orNull(parameters);
  dotted["technique"] = {{"properties", {{"parameters", orNull(parameters)}}}};
  json allowed = {{"properties", dotted}};
  allowed["patternProperties"]["^technique\\.parameters\\."] = true;
  json known = json::array();
  for (const auto& [name, ignored] : dotted.items())
    known.push_back(name);
  allowed["propertyNames"] = {{"anyOf", {{{"not", {{"pattern", "^technique\\.parameters\\."}}}}, {{"enum", known}}}}};
  return allowed;
}

json namesTechnique(const std::string& name) {
  const json dotted = {{"properties", {{"technique.name", {{"const", name}}}}}, {"required", {"technique.name"}}};
  json inside = {{"type", "object"}, {"properties", {{"name", {{"const", name}}}}}, {"required", {"name"}}};
  const json nested = {{"properties", {{"technique", inside}}}, {"required", {"technique"}}};
  return {{"anyOf", {dotted, nested}}};
}

json axesOf(const json& parameters) {
  json rules = json::array();
  for (const auto& [name, schema] : parameters["properties"].items()) {
    json rule;
    rule["if"] = {{"properties", {{"path", {{"const", "technique.parameters." + name}}}}}, {"required", {"path"}}};
    rule["then"] = {{"properties", {{"values", {{"items", schema}}}}}};
    rules.push_back(rule);
  }
  return rules;
}

/// Where a set (or a block's set and axes) names the technique, its parameters are known.
void addTechniques(const TechniqueCatalogue& techniques, json& set, json& block) {
  for (const CatalogueEntry& entry : techniques.entries()) {
    const TechniqueInfo& info = entry.factory->info;
    json properties = json::object();
    for (const ParameterDescriptor& parameter : info.parameters)
      properties[parameter.name] = keys::parameterSchema(parameter);
    const json parameters = closedObject(properties);

    json inSet;
    inSet["if"] = namesTechnique(info.name);
    inSet["then"] = parametersOf(parameters);
    set["allOf"].push_back(inSet);
    if (info.parameters.empty()) continue;

    json inBlock;
    inBlock["if"] = {{"properties", {{"set", namesTechnique(info.name)}}}, {"required", {"set"}}};
    inBlock["then"] = {{"properties", {{"axes", {{"additionalProperties", {{"allOf", axesOf(parameters)}}}}}}}};
    block["allOf"].push_back(inBlock);
  }
}

void nameTechniques(const TechniqueCatalogue& techniques, json& set) {
  if (techniques.entries().empty()) return;
  json names = json::array();
  for (const CatalogueEntry& entry : techniques.entries())
    names.push_back(entry.factory->info.name);
  const json name = orNull({{"enum", names}, {"description", "Name of a technique (volmark describe)."}});
  set["properties"]["technique.name"] = name;
  set["properties"]["technique"]["properties"]["name"] = name;
}

} // namespace

json scenarioSchema(const TechniqueCatalogue& techniques) {
  json set = setSchema();
  nameTechniques(techniques, set);
  json block = closedObject({{"set", {{"$ref", "#/$defs/set"}}},
                             {"exclude", exclusionsSchema()},
                             {"axes", {{"type", "object"}, {"additionalProperties", {{"$ref", "#/$defs/axis"}}}}}});
  addTechniques(techniques, set, block);

  const json text = {{"type", "string"}};
  const json blocks = {{"type", "array"}, {"items", {{"$ref", "#/$defs/block"}}}, {"minItems", 1}};
  const json patchedBlocks = {{"type", "object"}, {"additionalProperties", {{"type", {"object", "null"}}}}};
  const json patch = closedObject({{"title", {{"type", {"string", "null"}}}},
                                   {"description", {{"type", {"string", "null"}}}},
                                   {"set", orNull({{"$ref", "#/$defs/set"}})},
                                   {"blocks", {{"anyOf", {blocks, patchedBlocks, {{"type", "null"}}}}}},
                                   {"sample", {{"type", {"object", "null"}}}},
                                   {"limits", orNull({{"$ref", "#/$defs/limits"}})}});
  json schema = closedObject({{"$schema", text},
                              {"volmark", {{"const", 1}, {"description", "Version of the format."}}},
                              {"name", {{"type", "string"}, {"pattern", "^[A-Za-z0-9_][A-Za-z0-9_.-]{0,63}$"}}},
                              {"title", text},
                              {"description", text},
                              {"set", {{"$ref", "#/$defs/set"}}},
                              {"blocks", blocks},
                              {"sample", sampleSchema()},
                              {"limits", {{"$ref", "#/$defs/limits"}}},
                              {"profiles", {{"type", "object"}, {"additionalProperties", patch}}}});
  schema["$schema"] = kDraft;
  schema["title"] = "volmark scenario, version 1";
  schema["required"] = {"volmark", "name"};
  schema["$defs"] = {{"set", set}, {"block", block}, {"axis", axisSchema()}, {"limits", limitsSchema()}};
  return schema;
}

} // namespace volmark
