// Typed parameters of techniques. One descriptor drives schema, validation, defaults, `describe` and error
// texts.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace volmark {

using ParameterValue = std::variant<bool, std::int64_t, double, std::string>;

/// The type of a parameter is the type of its default value.
struct ParameterDescriptor {
  std::string name; ///< snake_case
  ParameterValue defaultValue;
  std::string unit;                   ///< "voxel", "ms", "" for none
  std::string documentation;          ///< one sentence
  std::optional<double> minimum;      ///< numbers only, inclusive
  std::optional<double> maximum;      ///< numbers only, inclusive
  std::vector<std::string> choices;   ///< strings only; empty allows any
  std::vector<std::int64_t> values{}; ///< integers only; empty allows all from minimum to maximum

  static ParameterDescriptor boolean(std::string name, bool value, std::string documentation);
  static ParameterDescriptor integer(std::string name, std::int64_t value, std::int64_t minimum, std::int64_t maximum,
                                     std::string unit, std::string documentation);
  /// One of a few integers: powers of two, for example.
  static ParameterDescriptor oneOf(std::string name, std::int64_t value, std::vector<std::int64_t> values,
                                   std::string unit, std::string documentation);
  static ParameterDescriptor number(std::string name, double value, double minimum, double maximum, std::string unit,
                                    std::string documentation);
  static ParameterDescriptor choice(std::string name, std::string value, std::vector<std::string> choices,
                                    std::string documentation);
};

/// "boolean", "integer", "number" or "string".
std::string_view typeNameOf(const ParameterValue& value);

/// Says what is wrong with a value for a parameter ("found 7, allowed 0.01 to 4 voxel"), or nothing. An
/// integer is accepted for a number (see normalised()).
std::optional<std::string> whyNotAllowed(const ParameterDescriptor& descriptor, const ParameterValue& value);

/// A complete, valid set: every descriptor has a value of its own type.
class ParameterValues {
public:
  ParameterValues() = default;
  /// Defaults for all. The descriptors are copied.
  explicit ParameterValues(std::span<const ParameterDescriptor> descriptors);

  /// Sets one value, widening integers to numbers. Throws InputError for an unknown name or a value that
  /// isn't allowed.
  void set(std::string_view name, ParameterValue value);

  bool boolean(std::string_view name) const;
  std::int64_t integer(std::string_view name) const;
  double number(std::string_view name) const;
  const std::string& text(std::string_view name) const;

  const std::vector<ParameterDescriptor>& descriptors() const { return m_descriptors; }
  const ParameterValue& value(std::string_view name) const;

private:
  std::vector<ParameterDescriptor> m_descriptors;
  std::vector<ParameterValue> m_values;
};

/// The candidate nearest to `name` by edit distance, if it is near enough to be a typing error.
std::optional<std::string> nearestName(std::string_view name, std::span<const std::string> candidates);

} // namespace volmark
