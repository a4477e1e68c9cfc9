// One technique module on disk.
#pragma once

#include "volmark/module.h"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

namespace volmark {

struct OpenModule {
  const ModuleDescription* description; ///< checked against this build; valid until the process ends
  std::string digest;                   ///< hex XXH3-128 of the file
};

/// Loads a module, checks it and makes its shaders known. The module stays loaded for the life of the process.
/// On failure the text is one line: file, what was found, what is expected.
std::pair<std::optional<OpenModule>, std::string> openModule(const std::filesystem::path& file);

} // namespace volmark
