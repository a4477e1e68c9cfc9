#include "scenario/strict_json.h"

#include "volmark/error.h"
#include "volmark/parameters.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <fstream>
#include <limits>

namespace volmark {

namespace {

constexpr std::uintmax_t kMaximumBytes = 4u << 20;
constexpr int kMaximumDepth = 64;
/// Ordered objects are searched linearly: with more keys a file of the largest size would take many seconds.
constexpr std::size_t kMaximumKeys = 512;
/// Bounds from here on are no bounds in an error text.
constexpr double kUnbounded = 1e300;

/// Keys come from files: no control character and no length may break an error's one line.
std::string printable(std::string_view text) {
  constexpr std::size_t kLongest = 100;
  if (text.size() > kLongest) return printable(text.substr(0, kLongest)) + "...";
  std::string result;
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      result += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    else
      result += c;
  }
  return result;
}

std::string pointerSegment(std::string_view key) {
  std::string result = "/";
  for (const char c : printable(key))
    result += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return result;
}

std::string at(const std::string& file, const std::string& pointer) {
  return pointer.empty() ? file : fmt::format("{}: {}", file, pointer);
}

/// Follows the parser to know where it is: refuses duplicate keys, deep nesting and huge objects.
class Watch {
public:
  explicit Watch(std::string place) : m_place(std::move(place)) {}

  void follow(nlohmann::ordered_json::parse_event_t event, const nlohmann::ordered_json& parsed) {
    using Event = nlohmann::ordered_json::parse_event_t;
    switch (event) {
    case Event::object_start:
    case Event::array_start: enter(event == Event::array_start); break;
    case Event::key: enterKey(parsed.get_ref<const std::string&>()); break;
    case Event::object_end:
    case Event::array_end: m_levels.pop_back(); [[fallthrough]];
    case Event::value:
      if (!m_levels.empty() && m_levels.back().isArray) ++m_levels.back().index;
      break;
    }
  }

private:
  struct Level {
    bool isArray = false;
    std::size_t index = 0;
    std::string key;
    std::set<std::string> keys;
  };

  void enter(bool isArray) {
    if (m_levels.size() >= kMaximumDepth)
      throw InputError(fmt::format("{}: nested too deeply, allowed: {} levels", m_place, kMaximumDepth));
    m_levels.push_back({.isArray = isArray});
  }

  void enterKey(const std::string& key) {
    Level& level = m_levels.back();
    if (!level.keys.insert(key).second)
      throw InputError(fmt::format("{}: key \"{}\" stands twice", at(m_place, pointer()), printable(key)));
    if (level.keys.size() > kMaximumKeys)
      throw InputError(fmt::format("{}: too many keys, allowed: {}", at(m_place, pointer()), kMaximumKeys));
    level.key = key;
  }

  /// The innermost object.
  std::string pointer() const {
    std::string result;
    for (std::size_t i = 0; i + 1 < m_levels.size(); ++i)
      result += m_levels[i].isArray ? fmt::format("/{}", m_levels[i].index) : pointerSegment(m_levels[i].key);
    return result;
  }

  std::string m_place;
  std::vector<Level> m_levels;
};

/// nlohmann's "[json.exception.parse_error.101] parse error at line 1, column 2: what" without the first parts.
std::string reasonOf(const nlohmann::json::exception& error) {
  const std::string text = error.what();
  const std::size_t column = text.find("column ");
  const std::size_t colon = text.find(": ", column == std::string::npos ? 0 : column);
  const std::size_t bracket = text.find("] ");
  if (column != std::string::npos && colon != std::string::npos) return printable(text.substr(colon + 2));
  return printable(bracket == std::string::npos ? text : text.substr(bracket + 2));
}

std::string lineAndColumn(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte == 0 ? 0 : byte - 1, text.size()));
  const auto line = std::count(before.begin(), before.end(), '\n') + 1;
  const std::size_t lineStart = before.rfind('\n');
  const std::size_t column = before.size() - (lineStart == std::string_view::npos ? 0 : lineStart + 1) + 1;
  return fmt::format("line {}, column {}", line, column);
}

std::string rangeText(std::string_view type, double minimum, double maximum) {
  const bool below = minimum <= -kUnbounded;
  const bool above = maximum >= kUnbounded;
  if (below && above) return std::string(type);
  if (above) return fmt::format("{} of at least {}", type, minimum);
  if (below) return fmt::format("{} of at most {}", type, maximum);
  return fmt::format("{} {} to {}", type, minimum, maximum);
}

} // namespace

nlohmann::ordered_json parseOrderedJson(std::string_view text, const std::string& place) {
  Watch watch(place);
  const auto follow = [&](int, nlohmann::ordered_json::parse_event_t event, nlohmann::ordered_json& parsed) {
    watch.follow(event, parsed);
    return true;
  };
  try {
    return nlohmann::ordered_json::parse(text, follow);
  } catch (const nlohmann::json::parse_error& error) {
    throw InputError(
        fmt::format("{}: {}: malformed JSON: {}", place, lineAndColumn(text, error.byte), reasonOf(error)));
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: malformed JSON: {}", place, reasonOf(error)));
  }
}

nlohmann::ordered_json readOrderedJsonFile(const std::filesystem::path& path) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code)) throw InputError(fmt::format("{}: no such file", path.string()));
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(fmt::format("{}: can't be opened", path.string()));
  const std::uintmax_t bytes = std::filesystem::file_size(path, code);
  if (code || bytes > kMaximumBytes)
    throw InputError(fmt::format("{}: found {} bytes, allowed: {}", path.string(), bytes, kMaximumBytes));
  std::string text(static_cast<std::size_t>(bytes), '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (static_cast<std::uintmax_t>(stream.gcount()) != bytes)
    throw InputError(fmt::format("{}: can't be read to its end", path.string()));
  return parseOrderedJson(text, path.string());
}

nlohmann::json readJsonFile(const std::filesystem::path& path) {
  return nlohmann::json(readOrderedJsonFile(path));
}

std::string shortJson(const nlohmann::json& value, std::size_t length) {
  const std::string text = value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  return text.size() <= length ? text : text.substr(0, length) + "...";
}

std::string suggestion(std::string_view name, const std::vector<std::string>& candidates) {
  const auto nearest = nearestName(name, candidates);
  return nearest ? fmt::format(", did you mean \"{}\"?", *nearest) : "";
}

std::string quotedList(const std::vector<std::string>& names) {
  return names.empty() ? "none" : fmt::format("\"{}\"", fmt::join(names, "\", \""));
}

JsonValue::JsonValue(const nlohmann::json& value, std::string file, std::string pointer)
    : m_value(&value), m_file(std::move(file)), m_pointer(std::move(pointer)) {
}

void JsonValue::fail(std::string_view message) const {
  throw InputError(fmt::format("{}: {}", at(m_file, m_pointer), message));
}

void JsonValue::refuse(std::string_view allowed) const {
  fail(fmt::format("found {}, allowed: {}", shortJson(*m_value), allowed));
}

bool JsonValue::boolean() const {
  if (!m_value->is_boolean()) refuse("true or false");
  return m_value->get<bool>();
}

std::int64_t JsonValue::integer(std::int64_t minimum, std::int64_t maximum) const {
  const std::string allowed = fmt::format("integer {} to {}", minimum, maximum);
  if (!m_value->is_number_integer()) refuse(allowed);
  if (m_value->is_number_unsigned() &&
      m_value->get<std::uint64_t>() > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
    refuse(allowed);
  const auto value = m_value->get<std::int64_t>();
  if (value < minimum || value > maximum) refuse(allowed);
  return value;
}

double JsonValue::number(double minimum, double maximum) const {
  const std::string allowed = rangeText("number", minimum, maximum);
  if (!m_value->is_number()) refuse(allowed);
  const auto value = m_value->get<double>();
  if (!std::isfinite(value) || value < minimum || value > maximum) refuse(allowed);
  return value;
}

std::string JsonValue::text() const {
  if (!m_value->is_string() || m_value->get_ref<const std::string&>().empty()) refuse("text that is not empty");
  return m_value->get<std::string>();
}

std::string JsonValue::choice(const std::vector<std::string>& choices) const {
  if (!m_value->is_string()) refuse(quotedList(choices));
  const auto& value = m_value->get_ref<const std::string&>();
  if (std::find(choices.begin(), choices.end(), value) != choices.end()) return value;
  const std::string nearest = suggestion(value, choices);
  fail(
      fmt::format("found {}{} allowed: {}", shortJson(*m_value), nearest.empty() ? "," : nearest, quotedList(choices)));
}

std::vector<double> JsonValue::numbers(std::size_t count, double minimum, double maximum) const {
  if (!m_value->is_array() || m_value->size() != count)
    refuse(fmt::format("array of {} numbers, each {}", count, rangeText("number", minimum, maximum)));
  std::vector<double> result;
  for (std::size_t i = 0; i < count; ++i)
    result.push_back(element(i).number(minimum, maximum));
  return result;
}

std::vector<JsonValue> JsonValue::array() const {
  if (!m_value->is_array()) refuse("array");
  std::vector<JsonValue> result;
  for (std::size_t i = 0; i < m_value->size(); ++i)
    result.push_back(element(i));
  return result;
}

JsonValue JsonValue::member(const std::string& key) const {
  assert(m_value->is_object() && m_value->contains(key));
  return JsonValue(*m_value->find(key), m_file, m_pointer + pointerSegment(key));
}

JsonValue JsonValue::element(std::size_t index) const {
  assert(m_value->is_array() && index < m_value->size());
  return JsonValue((*m_value)[index], m_file, fmt::format("{}/{}", m_pointer, index));
}

JsonObject::JsonObject(const JsonValue& value) : m_value(value) {
  if (!value.isObject()) value.refuse("object");
}

bool JsonObject::has(const std::string& key) {
  m_known.insert(key);
  return m_value.json().contains(key);
}

JsonValue JsonObject::at(const std::string& key) {
  if (!has(key)) m_value.fail(fmt::format("key \"{}\" is missing", key));
  return m_value.member(key);
}

std::optional<JsonValue> JsonObject::find(const std::string& key) {
  if (!has(key)) return std::nullopt;
  return m_value.member(key);
}

void JsonObject::refuseOthers() const {
  const std::vector<std::string> known(m_known.begin(), m_known.end());
  for (const auto& [key, ignored] : m_value.json().items()) {
    if (m_known.count(key) != 0) continue;
    const std::string nearest = suggestion(key, known);
    m_value.fail(fmt::format("unknown key \"{}\"{} allowed: {}", printable(key), nearest.empty() ? "," : nearest,
                             known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", "))));
  }
}

} // namespace volmark
