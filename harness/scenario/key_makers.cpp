#include "scenario/key_makers.h"

#include <fmt/format.h>

namespace volmark::keys {

nlohmann::json numberSchema(double minimum, double maximum) {
  nlohmann::json schema = {{"type", "number"}};
  if (minimum > -kAnyNumber) schema["minimum"] = minimum;
  if (maximum < kAnyNumber) schema["maximum"] = maximum;
  return schema;
}

nlohmann::json vectorSchema(double minimum, double maximum) {
  return {{"type", "array"}, {"items", numberSchema(minimum, maximum)}, {"minItems", 3}, {"maxItems", 3}};
}

nlohmann::json parameterSchema(const ParameterDescriptor& parameter) {
  nlohmann::json schema = {
      {"type", std::string(typeNameOf(parameter.defaultValue))},
      {"description",
       parameter.documentation + (parameter.unit.empty() ? "" : fmt::format(" Unit: {}.", parameter.unit))}};
  std::visit([&](const auto& value) { schema["default"] = value; }, parameter.defaultValue);
  if (parameter.minimum) schema["minimum"] = *parameter.minimum;
  if (parameter.maximum) schema["maximum"] = *parameter.maximum;
  if (!parameter.choices.empty()) schema["enum"] = parameter.choices;
  if (!parameter.values.empty()) schema["enum"] = parameter.values;
  return schema;
}

nlohmann::json toJson(const glm::dvec3& v) {
  return {canonical(v.x), canonical(v.y), canonical(v.z)};
}

glm::dvec3 vectorFrom(const JsonValue& value, double minimum, double maximum) {
  const std::vector<double> v = value.numbers(3, minimum, maximum);
  return {v[0], v[1], v[2]};
}

glm::dvec3 directionFrom(const JsonValue& value) {
  const glm::dvec3 v = vectorFrom(value, -1e9, 1e9);
  const double length = glm::length(v);
  if (length < 1e-9) value.refuse("a vector with a length");
  // Normalising twice may change the last bit, and with it the hash of a configuration that is read back.
  return std::abs(length - 1) < 1e-14 ? v : v / length;
}

PointKey plain(std::string path, std::string unit, std::string documentation, nlohmann::json schema,
               std::function<void(const JsonValue&, PointSettings&)> read,
               std::function<nlohmann::json(const PointSettings&)> write) {
  PointKey key;
  key.path = std::move(path);
  key.documentation = std::move(documentation);
  key.unit = std::move(unit);
  key.schema = std::move(schema);
  key.check = [read](const JsonValue& value) {
    PointSettings scratch;
    read(value, scratch);
  };
  key.read = std::move(read);
  key.write = std::move(write);
  return key;
}

nlohmann::json isovalueSchema() {
  const auto one = [](const char* name, nlohmann::json value) {
    return nlohmann::json{{"type", "object"},
                          {"properties", {{name, std::move(value)}}},
                          {"required", {name}},
                          {"additionalProperties", false}};
  };
  return {{"anyOf",
           {one("normalized", numberSchema(0, 1)),
            one("raw", numberSchema(-kAnyNumber, kAnyNumber)),
            {{"type", "string"}, {"minLength", 1}}}}};
}

void checkIsovalue(const JsonValue& value) {
  if (value.json().is_string())
    value.text();
  else
    parseIsovalue(value);
}

Isovalue resolveIsovalue(const JsonValue& value, const SceneDescription& scene) {
  if (!value.json().is_string()) return parseIsovalue(value);
  const std::string name = value.text();
  std::vector<std::string> names;
  for (const auto& [known, isovalue] : scene.isovalues) {
    if (known == name) return isovalue;
    names.push_back(known);
  }
  const std::string nearest = suggestion(name, names);
  value.fail(fmt::format("unknown isovalue \"{}\" of scene \"{}\"{} allowed: {}", name, scene.name,
                         nearest.empty() ? "," : nearest, quotedList(names)));
}

nlohmann::json toJson(const Isovalue& isovalue) {
  return {{isovalue.raw ? "raw" : "normalized", canonical(isovalue.value)}};
}

std::shared_ptr<const TransferFunction> resolveTransferFunction(const JsonValue& value, const SceneDescription& scene) {
  if (!value.json().is_string()) return std::make_shared<TransferFunction>(parseTransferFunction("inline", value));
  const std::string name = value.text();
  std::vector<std::string> names;
  for (const auto& [known, function] : scene.transferFunctions) {
    if (known == name) return std::make_shared<TransferFunction>(function);
    names.push_back(known);
  }
  const std::string nearest = suggestion(name, names);
  value.fail(fmt::format("unknown transfer function \"{}\" of scene \"{}\"{} allowed: {}", name, scene.name,
                         nearest.empty() ? "," : nearest, quotedList(names)));
}

nlohmann::json transferFunctionSchema() {
  const nlohmann::json point = {
      {"type", "object"},
      {"properties", {{"value", numberSchema(0, 1)}, {"color", vectorSchema(0, 1)}, {"opacity", numberSchema(0, 1)}}},
      {"required", {"value", "color", "opacity"}},
      {"additionalProperties", false}};
  return {{"anyOf",
           {{{"type", "string"}, {"minLength", 1}},
            {{"type", "object"},
             {"properties", {{"points", {{"type", "array"}, {"items", point}, {"minItems", 1}}}}},
             {"required", {"points"}},
             {"additionalProperties", false}}}}};
}

void checkTransferFunction(const JsonValue& value) {
  if (value.json().is_string())
    value.text();
  else
    parseTransferFunction("inline", value);
}

nlohmann::json toJson(const TransferFunction& function) {
  nlohmann::json points = nlohmann::json::array();
  for (const ControlPoint& point : function.points())
    points.push_back(
        {{"value", canonical(point.value)}, {"color", toJson(point.color)}, {"opacity", canonical(point.opacity)}});
  return {{"points", points}};
}

} // namespace volmark::keys
