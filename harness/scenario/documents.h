// Scenario documents before expansion: reading, checking and merging of file, profiles and assignments.
#pragma once

#include "scenario/scenario.h"
#include "scenario/strict_json.h"

#include <nlohmann/json.hpp>

namespace volmark {

/// A merged scenario document. Objects keep the order of the file; every "set" is flat: dotted paths to values.
struct ScenarioDocument {
  nlohmann::ordered_json json;
  std::string place; ///< the file, for errors, and the profile if there is one
};

/// File < profile < the file's own profile < assignments; each checked alone, with its own file and pointer in
/// errors, and then the whole. Throws InputError.
ScenarioDocument readDocument(const ScenarioOptions& options);

/// "limits" of a document.
Limits readLimits(const JsonValue& value);

} // namespace volmark
