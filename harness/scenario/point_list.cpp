#include "scenario/point_list.h"

#include "scenario/strict_json.h"
#include "volmark/error.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <set>
#include <sstream>

namespace volmark {

namespace {

std::optional<int> wholeNumber(const std::string& text) {
  int value = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return !text.empty() && text.front() != '-' && error == std::errc() && rest == end ? std::optional(value)
                                                                                     : std::nullopt;
}

} // namespace

std::vector<int> parsePointList(const std::string& text, int count, const std::string& option) {
  const auto refuse = [&](const std::string& found) {
    throw InputError(fmt::format("{}: found {}, allowed: numbers and ranges of 0 to {}, as in 3,7-12", option,
                                 shortJson(found), count - 1));
  };
  std::set<int> chosen;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t dash = part.find('-');
    const auto first = wholeNumber(part.substr(0, dash));
    const auto last = dash == std::string::npos ? first : wholeNumber(part.substr(dash + 1));
    if (!first || !last || *first > *last || *last >= count) refuse(part);
    for (int i = *first; i <= *last; ++i)
      chosen.insert(i);
  }
  if (chosen.empty()) refuse(text);
  return {chosen.begin(), chosen.end()};
}

} // namespace volmark
