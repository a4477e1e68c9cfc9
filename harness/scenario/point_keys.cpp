#include "scenario/point_keys.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <string_view>

namespace volmark {

namespace {

std::string pointerOf(const PointKey& key) {
  std::string pointer = "/" + key.path;
  std::replace(pointer.begin(), pointer.end(), '.', '/');
  return pointer;
}

} // namespace

nlohmann::json PointKey::defaultValue() const {
  return derivedDefault.empty() ? write(PointSettings{}) : nlohmann::json();
}

const std::vector<PointKey>& pointKeys() {
  static const std::vector<PointKey> keys = [] {
    std::vector<PointKey> all = contentKeys();
    for (std::vector<PointKey> part : {viewKeys(), measurementKeys()})
      std::move(part.begin(), part.end(), std::back_inserter(all));
    return all;
  }();
  return keys;
}

const PointKey* findPointKey(const std::string& path) {
  static const std::map<std::string, const PointKey*, std::less<>> byPath = [] {
    std::map<std::string, const PointKey*, std::less<>> result;
    for (const PointKey& key : pointKeys())
      result.emplace(key.path, &key);
    return result;
  }();
  const auto found = byPath.find(path);
  return found == byPath.end() ? nullptr : found->second;
}

nlohmann::json writePoint(const PointSettings& settings) {
  nlohmann::json config = nlohmann::json::object();
  for (const PointKey& key : pointKeys()) {
    if (key.applies && !key.applies(settings)) continue;
    config[nlohmann::json::json_pointer(pointerOf(key))] = key.write(settings);
  }
  return config;
}

nlohmann::json withoutDefaults(nlohmann::json config) {
  for (const PointKey& key : pointKeys()) {
    const nlohmann::json::json_pointer pointer(pointerOf(key));
    const nlohmann::json defaultValue = key.defaultValue();
    if (defaultValue.is_null() || !config.contains(pointer) || config[pointer] != defaultValue) continue;
    nlohmann::json& parent = config[pointer.parent_pointer()];
    parent.erase(pointer.back());
    if (parent.empty() && !pointer.parent_pointer().empty()) {
      const auto outer = pointer.parent_pointer();
      config[outer.parent_pointer()].erase(outer.back());
    }
  }
  return config;
}

} // namespace volmark
