// The shape of scenario documents, whole ones and patches.
#pragma once

#include "scenario/strict_json.h"

#include <nlohmann/json.hpp>

namespace volmark {

enum class DocumentKind {
  file,        ///< a scenario file: may have profiles
  profileFile, ///< configs/profiles/<name>.json: a patch with a version
  patch,       ///< profiles.<name> of a file, or an assignment
};

/// Checks all keys and values as far as the document alone allows. Throws InputError.
void checkDocument(const JsonValue& document, DocumentKind kind);

/// Makes every "set" flat. The document has been checked.
void flattenSets(nlohmann::ordered_json& document, const std::string& place);

} // namespace volmark
