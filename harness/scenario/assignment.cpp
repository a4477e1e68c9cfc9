#include "scenario/assignment.h"

#include "scenario/strict_json.h"
#include "volmark/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace volmark {

namespace {

using Ordered = nlohmann::ordered_json;

Ordered valueOf(const std::string& text, const std::string& place) {
  try {
    return parseOrderedJson(text, place);
  } catch (const InputError&) {
    const bool bare = !text.empty() && std::none_of(text.begin(), text.end(), [](char c) {
      return static_cast<unsigned char>(c) <= 0x20 || std::string_view("[]{}\",").find(c) != std::string_view::npos;
    });
    if (!bare) throw;
    return text;
  }
}

} // namespace

Assignment parseAssignment(const std::string& text) {
  const std::string place = "--set " + text;
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) throw InputError(fmt::format("{}: allowed: key.path=value", place));
  return {text.substr(0, equals), valueOf(text.substr(equals + 1), place), place};
}

} // namespace volmark
