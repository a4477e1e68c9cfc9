#include "volmark/parameters.h"

#include "volmark/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace volmark {

namespace {

std::string textOf(const ParameterValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return fmt::format("\"{}\"", *text);
  return std::visit([](const auto& v) -> std::string { return fmt::format("{}", v); }, value);
}

std::string allowedText(const ParameterDescriptor& descriptor) {
  if (!descriptor.choices.empty()) return fmt::format("\"{}\"", fmt::join(descriptor.choices, "\", \""));
  const std::string unit = descriptor.unit.empty() ? "" : " " + descriptor.unit;
  if (!descriptor.values.empty()) return fmt::format("{}{}", fmt::join(descriptor.values, ", "), unit);
  if (descriptor.minimum && descriptor.maximum)
    return fmt::format("{} {} to {}{}", typeNameOf(descriptor.defaultValue), *descriptor.minimum, *descriptor.maximum,
                       unit);
  return std::string(typeNameOf(descriptor.defaultValue)) + unit;
}

std::optional<double> asNumber(const ParameterValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return static_cast<double>(*integer);
  return std::nullopt;
}

std::size_t indexOf(const std::vector<ParameterDescriptor>& descriptors, std::string_view name) {
  const auto found = std::find_if(descriptors.begin(), descriptors.end(),
                                  [&](const ParameterDescriptor& descriptor) { return descriptor.name == name; });
  return static_cast<std::size_t>(found - descriptors.begin());
}

int editDistance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j)
    row[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

} // namespace

ParameterDescriptor ParameterDescriptor::boolean(std::string name, bool value, std::string documentation) {
  return {std::move(name), value, "", std::move(documentation), {}, {}, {}};
}

ParameterDescriptor ParameterDescriptor::integer(std::string name, std::int64_t value, std::int64_t minimum,
                                                 std::int64_t maximum, std::string unit, std::string documentation) {
  return {std::move(name),
          value,
          std::move(unit),
          std::move(documentation),
          static_cast<double>(minimum),
          static_cast<double>(maximum),
          {}};
}

ParameterDescriptor ParameterDescriptor::oneOf(std::string name, std::int64_t value, std::vector<std::int64_t> values,
                                               std::string unit, std::string documentation) {
  return {std::move(name), value, std::move(unit), std::move(documentation), {}, {}, {}, std::move(values)};
}

ParameterDescriptor ParameterDescriptor::number(std::string name, double value, double minimum, double maximum,
                                                std::string unit, std::string documentation) {
  return {std::move(name), value, std::move(unit), std::move(documentation), minimum, maximum, {}};
}

ParameterDescriptor ParameterDescriptor::choice(std::string name, std::string value, std::vector<std::string> choices,
                                                std::string documentation) {
  return {std::move(name), std::move(value), "", std::move(documentation), {}, {}, std::move(choices)};
}

std::string_view typeNameOf(const ParameterValue& value) {
  constexpr std::string_view names[] = {"boolean", "integer", "number", "string"};
  return names[value.index()];
}

std::optional<std::string> whyNotAllowed(const ParameterDescriptor& descriptor, const ParameterValue& value) {
  const bool widens =
      std::holds_alternative<double>(descriptor.defaultValue) && std::holds_alternative<std::int64_t>(value);
  bool allowed = descriptor.defaultValue.index() == value.index() || widens;
  if (const auto number = asNumber(value); allowed && number)
    allowed = std::isfinite(*number) && (!descriptor.minimum || *number >= *descriptor.minimum) &&
              (!descriptor.maximum || *number <= *descriptor.maximum);
  if (const auto* text = std::get_if<std::string>(&value); allowed && text && !descriptor.choices.empty())
    allowed = std::find(descriptor.choices.begin(), descriptor.choices.end(), *text) != descriptor.choices.end();
  if (const auto* integer = std::get_if<std::int64_t>(&value); allowed && integer && !descriptor.values.empty())
    allowed = std::find(descriptor.values.begin(), descriptor.values.end(), *integer) != descriptor.values.end();
  if (allowed) return std::nullopt;
  return fmt::format("found {}, allowed: {}", textOf(value), allowedText(descriptor));
}

ParameterValues::ParameterValues(std::span<const ParameterDescriptor> descriptors)
    : m_descriptors(descriptors.begin(), descriptors.end()) {
  for (const ParameterDescriptor& descriptor : m_descriptors)
    m_values.push_back(descriptor.defaultValue);
}

void ParameterValues::set(std::string_view name, ParameterValue value) {
  const std::size_t index = indexOf(m_descriptors, name);
  if (index == m_descriptors.size()) {
    std::vector<std::string> names;
    for (const ParameterDescriptor& descriptor : m_descriptors)
      names.push_back(descriptor.name);
    const auto nearest = nearestName(name, names);
    throw InputError(fmt::format("unknown parameter \"{}\"{}; allowed: {}", name,
                                 nearest ? fmt::format(", did you mean \"{}\"?", *nearest) : "",
                                 names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
  }
  const ParameterDescriptor& descriptor = m_descriptors[index];
  if (const auto why = whyNotAllowed(descriptor, value)) throw InputError(fmt::format("{}: {}", name, *why));
  if (std::holds_alternative<double>(descriptor.defaultValue)) value = *asNumber(value);
  m_values[index] = std::move(value);
}

const ParameterValue& ParameterValues::value(std::string_view name) const {
  const std::size_t index = indexOf(m_descriptors, name);
  assert(index < m_values.size() && "a technique asked for a parameter that it does not declare");
  return m_values.at(index);
}

bool ParameterValues::boolean(std::string_view name) const {
  return std::get<bool>(value(name));
}

std::int64_t ParameterValues::integer(std::string_view name) const {
  return std::get<std::int64_t>(value(name));
}

double ParameterValues::number(std::string_view name) const {
  return std::get<double>(value(name));
}

const std::string& ParameterValues::text(std::string_view name) const {
  return std::get<std::string>(value(name));
}

std::optional<std::string> nearestName(std::string_view name, std::span<const std::string> candidates) {
  const std::string* best = nullptr;
  int bestDistance = std::max(2, static_cast<int>(name.size()) / 3) + 1;
  for (const std::string& candidate : candidates) {
    const int distance = editDistance(name, candidate);
    if (distance < bestDistance) {
      best = &candidate;
      bestDistance = distance;
    }
  }
  if (!best) return std::nullopt;
  return *best;
}

} // namespace volmark
