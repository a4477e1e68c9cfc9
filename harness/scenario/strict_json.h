// Reading JSON strictly: every error is one line with file, JSON pointer, what was found, what is allowed
// and, for an unknown key, the nearest known one.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace volmark {

/// Parses a file. Throws InputError: missing file, over 16 MiB, malformed JSON (with line and column), deeper
/// than 64 levels, duplicate keys.
nlohmann::json readJsonFile(const std::filesystem::path& path);
/// The same, with objects in the file's order: for axes and for "the first isovalue".
nlohmann::ordered_json readOrderedJsonFile(const std::filesystem::path& path);
/// Parses text under the same rules; `place` stands for the file in errors.
nlohmann::ordered_json parseOrderedJson(std::string_view text, const std::string& place);

/// JSON text of a value for one line of an error: at most `length` characters, then "...".
std::string shortJson(const nlohmann::json& value, std::size_t length = 60);
/// ", did you mean \"x\"?" or nothing.
std::string suggestion(std::string_view name, const std::vector<std::string>& candidates);
/// "a", "b", "c" in quotes, or the word none.
std::string quotedList(const std::vector<std::string>& names);

/// One value with the place it stands at. The JSON must outlive it.
class JsonValue {
public:
  JsonValue(const nlohmann::json& value, std::string file, std::string pointer = "");
  JsonValue(const nlohmann::json&& value, std::string file, std::string pointer = "") = delete;

  const nlohmann::json& json() const { return *m_value; }
  const std::string& file() const { return m_file; }
  const std::string& pointer() const { return m_pointer; }

  /// Throws InputError "<file>: <pointer>: found <found>, allowed: <allowed>".
  [[noreturn]] void refuse(std::string_view allowed) const;
  /// The same with a free sentence instead.
  [[noreturn]] void fail(std::string_view message) const;

  bool boolean() const;
  std::int64_t integer(std::int64_t minimum, std::int64_t maximum) const;
  double number(double minimum, double maximum) const; ///< finite
  std::string text() const;                            ///< not empty
  /// One of `choices`; the error names the nearest.
  std::string choice(const std::vector<std::string>& choices) const;
  std::vector<double> numbers(std::size_t count, double minimum, double maximum) const; ///< exactly `count`
  std::vector<JsonValue> array() const;
  /// The member `key` of an object, or element of an array, as a place for errors. It must be there.
  JsonValue member(const std::string& key) const;
  JsonValue element(std::size_t index) const;

  bool isObject() const { return m_value->is_object(); }

private:
  const nlohmann::json* m_value;
  std::string m_file;
  std::string m_pointer;
};

/// An object whose keys must all be asked for.
class JsonObject {
public:
  /// Throws InputError if `value` isn't an object.
  explicit JsonObject(const JsonValue& value);

  bool has(const std::string& key);     ///< the key counts as known
  JsonValue at(const std::string& key); ///< throws if it is missing
  std::optional<JsonValue> find(const std::string& key);

  /// Throws InputError for the first key that nobody asked for.
  void refuseOthers() const;

  const JsonValue& value() const { return m_value; }

private:
  JsonValue m_value;
  std::set<std::string> m_known;
};

} // namespace volmark
