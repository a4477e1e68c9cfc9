// The keys of a point. One table drives reading, defaults, the resolved configuration, the JSON Schema and the
// printed documentation.
#pragma once

#include "scenario/point.h"
#include "scenario/strict_json.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <string>
#include <vector>

namespace volmark {

struct PointKey {
  std::string path;           ///< dotted: "pacing.frames"
  std::string documentation;  ///< one sentence
  std::string unit;           ///< "" for none
  nlohmann::json schema;      ///< JSON Schema of the value
  std::string derivedDefault; ///< says what the default is where it isn't constant: "the scene's first"
  bool open = false;          ///< members are keys that only the technique knows

  /// Checks as far as possible without scene and technique. Throws InputError.
  std::function<void(const JsonValue&)> check;
  /// Reads into settings whose scene and technique are known. Throws InputError.
  std::function<void(const JsonValue&, PointSettings&)> read;
  /// The canonical value.
  std::function<nlohmann::json(const PointSettings&)> write;
  /// Whether the key means anything beside the others ("pacing.seconds" doesn't in frames pacing); empty: always.
  std::function<bool(const PointSettings&)> applies;

  /// The default as JSON; null if it is derived.
  nlohmann::json defaultValue() const;
};

/// All keys, in the order in which they are documented.
const std::vector<PointKey>& pointKeys();
/// Nothing if `path` isn't the whole path of a key.
const PointKey* findPointKey(const std::string& path);

/// The canonical configuration: every key that applies, nested.
nlohmann::json writePoint(const PointSettings& settings);

/// The same configuration without what equals a default: reads to the same settings, also in a program that doesn't
/// know every key.
nlohmann::json withoutDefaults(nlohmann::json config);

// Tables of the parts; joined by pointKeys().
std::vector<PointKey> contentKeys();     ///< scene, volume, technique, isovalue, transfer function, shading, light
std::vector<PointKey> viewKeys();        ///< resolution, stereo, camera, timeline
std::vector<PointKey> measurementKeys(); ///< pacing, measure, pictures

} // namespace volmark
