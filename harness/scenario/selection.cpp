#include "scenario/selection.h"

#include "volmark/random.h"

#include <algorithm>
#include <numeric>

namespace volmark {

namespace {

std::map<std::string, std::set<std::string>> readEntry(const JsonValue& value) {
  if (!value.isObject() || value.json().empty()) value.refuse("object of values by axis, as in {\"step\": 0.5}");
  std::map<std::string, std::set<std::string>> entry;
  for (const auto& [axis, given] : value.json().items()) {
    const bool many = given.is_array();
    if (many && given.empty()) value.member(axis).refuse("a value or a list of values");
    for (const auto& one : many ? given : nlohmann::json::array({given}))
      entry[axis].insert(labelOfValue(one));
  }
  return entry;
}

/// FNV-1a, 64 bits: the same on every machine.
std::uint64_t hashOf(const std::vector<Label>& labels) {
  std::uint64_t hash = 14695981039346656037ull;
  const auto add = [&hash](const std::string& text) {
    for (const char letter : text + '\n')
      hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211ull;
  };
  for (const Label& label : labels) {
    add(label.axis);
    add(label.value);
  }
  return hash;
}

} // namespace

std::string labelOfValue(const nlohmann::json& value) {
  return value.is_string() ? value.get<std::string>() : shortJson(value, 200);
}

Exclusions::Exclusions(const JsonValue& list, const std::set<std::string>& axes) {
  for (const JsonValue& value : list.array()) {
    m_entries.push_back(readEntry(value));
    for (const auto& [axis, ignored] : m_entries.back())
      if (axes.count(axis) == 0)
        value.fail("no axis " + shortJson(axis) + " in this block" +
                   suggestion(axis, std::vector<std::string>(axes.begin(), axes.end())));
  }
}

void checkExclusions(const JsonValue& list) {
  for (const JsonValue& value : list.array())
    readEntry(value);
}

bool Exclusions::leaveOut(const std::map<std::string, std::string>& labels) const {
  return std::any_of(m_entries.begin(), m_entries.end(), [&labels](const auto& entry) {
    return std::all_of(entry.begin(), entry.end(), [&labels](const auto& axis) {
      const auto found = labels.find(axis.first);
      return found != labels.end() && axis.second.count(found->second) > 0;
    });
  });
}

Sample readSample(const JsonValue& value) {
  Sample sample;
  JsonObject object(value);
  sample.count = static_cast<int>(object.at("count").integer(1, 100000));
  if (const auto seed = object.find("seed")) sample.seed = static_cast<std::uint32_t>(seed->integer(0, 0xffffffff));
  object.refuseOthers();
  return sample;
}

void keepSample(const Sample& sample, std::vector<Point>& points) {
  if (points.size() <= static_cast<std::size_t>(sample.count)) return;
  std::vector<std::pair<std::uint64_t, std::size_t>> ranks;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint64_t hash = hashOf(points[i].labels);
    const auto low = static_cast<std::uint32_t>(hash);
    const auto high = static_cast<std::uint32_t>(hash >> 32u);
    const std::uint64_t rank =
        std::uint64_t(randomBits(sample.seed, low, high, 0)) << 32u | randomBits(sample.seed, low, high, 1);
    ranks.emplace_back(rank, i);
  }
  std::sort(ranks.begin(), ranks.end());
  ranks.resize(static_cast<std::size_t>(sample.count));
  std::sort(ranks.begin(), ranks.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<Point> kept;
  for (const auto& [ignored, i] : ranks) {
    kept.push_back(std::move(points[i]));
    kept.back().index = static_cast<int>(kept.size()) - 1;
  }
  points = std::move(kept);
}

} // namespace volmark
