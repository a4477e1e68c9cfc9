// Makes entries of the table of point keys from a type, a range and the member that holds the value.
// `member` is a generic function: [](auto& s) -> auto& { return s.camera.verticalFovDegrees; }.
#pragma once

#include "scenario/point_keys.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace volmark::keys {

/// "No bound" where JSON numbers have to be finite.
inline constexpr double kAnyNumber = 1e300;

/// Equal values have equal text: no negative zero.
inline double canonical(double value) {
  return value + 0.0;
}

nlohmann::json numberSchema(double minimum, double maximum);
nlohmann::json vectorSchema(double minimum, double maximum);
/// Type, range, choices, default and documentation of a parameter.
nlohmann::json parameterSchema(const ParameterDescriptor& parameter);
nlohmann::json toJson(const glm::dvec3& v);
glm::dvec3 vectorFrom(const JsonValue& value, double minimum, double maximum);
/// Refuses vectors shorter than 1e-9. Unit vectors come back bit by bit.
glm::dvec3 directionFrom(const JsonValue& value);

/// A key whose check is reading it into default settings.
PointKey plain(std::string path, std::string unit, std::string documentation, nlohmann::json schema,
               std::function<void(const JsonValue&, PointSettings&)> read,
               std::function<nlohmann::json(const PointSettings&)> write);

template <class Member> PointKey boolean(std::string path, Member member, std::string documentation) {
  return plain(
      std::move(path), "", std::move(documentation), {{"type", "boolean"}},
      [=](const JsonValue& value, PointSettings& s) { member(s) = value.boolean(); },
      [=](const PointSettings& s) { return nlohmann::json(member(s)); });
}

template <class Member>
PointKey integer(std::string path, Member member, std::int64_t minimum, std::int64_t maximum,
                 std::string documentation) {
  return plain(
      std::move(path), "", std::move(documentation), {{"type", "integer"}, {"minimum", minimum}, {"maximum", maximum}},
      [=](const JsonValue& value, PointSettings& s) {
        auto& target = member(s);
        target = static_cast<std::remove_reference_t<decltype(target)>>(value.integer(minimum, maximum));
      },
      [=](const PointSettings& s) { return nlohmann::json(member(s)); });
}

template <class Member>
PointKey number(std::string path, Member member, double minimum, double maximum, std::string unit,
                std::string documentation) {
  return plain(
      std::move(path), std::move(unit), std::move(documentation), numberSchema(minimum, maximum),
      [=](const JsonValue& value, PointSettings& s) { member(s) = value.number(minimum, maximum); },
      [=](const PointSettings& s) { return nlohmann::json(canonical(member(s))); });
}

template <class Member, class Value>
PointKey choice(std::string path, Member member, std::vector<std::pair<std::string, Value>> choices,
                std::string documentation) {
  std::vector<std::string> names;
  for (const auto& entry : choices)
    names.push_back(entry.first);
  return plain(
      std::move(path), "", std::move(documentation), {{"enum", names}},
      [=](const JsonValue& value, PointSettings& s) {
        const std::string name = value.choice(names);
        const auto found = std::find_if(choices.begin(), choices.end(), [&](const auto& e) { return e.first == name; });
        member(s) = found->second;
      },
      [=](const PointSettings& s) {
        const auto found =
            std::find_if(choices.begin(), choices.end(), [&](const auto& e) { return e.second == member(s); });
        return nlohmann::json(found->first);
      });
}

template <class Member>
PointKey vector(std::string path, Member member, double minimum, double maximum, std::string documentation) {
  return plain(
      std::move(path), "", std::move(documentation), vectorSchema(minimum, maximum),
      [=](const JsonValue& value, PointSettings& s) { member(s) = vectorFrom(value, minimum, maximum); },
      [=](const PointSettings& s) { return toJson(member(s)); });
}

template <class Member> PointKey direction(std::string path, Member member, std::string documentation) {
  return plain(
      std::move(path), "", std::move(documentation), vectorSchema(-kAnyNumber, kAnyNumber),
      [=](const JsonValue& value, PointSettings& s) { member(s) = directionFrom(value); },
      [=](const PointSettings& s) { return toJson(member(s)); });
}

inline PointKey derived(PointKey key, std::string derivedDefault) {
  key.derivedDefault = std::move(derivedDefault);
  return key;
}

inline PointKey onlyIf(std::function<bool(const PointSettings&)> applies, PointKey key) {
  key.applies = std::move(applies);
  return key;
}

/// Schema, reading and writing of an isovalue: {"normalized"}, {"raw"} or a name in the scene.
nlohmann::json isovalueSchema();
void checkIsovalue(const JsonValue& value);
Isovalue resolveIsovalue(const JsonValue& value, const SceneDescription& scene);
nlohmann::json toJson(const Isovalue& isovalue);

/// The same of a transfer function: {"points"} or a name in the scene.
nlohmann::json transferFunctionSchema();
void checkTransferFunction(const JsonValue& value);
std::shared_ptr<const TransferFunction> resolveTransferFunction(const JsonValue& value, const SceneDescription& scene);
nlohmann::json toJson(const TransferFunction& function);

} // namespace volmark::keys
