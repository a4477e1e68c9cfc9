#include "scenario/point_keys.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <string_view>

namespace volmark {

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
    std::string pointer = "/" + key.path;
    std::replace(pointer.begin(), pointer.end(), '.', '/');
    config[nlohmann::json::json_pointer(pointer)] = key.write(settings);
  }
  return config;
}

} // namespace volmark
