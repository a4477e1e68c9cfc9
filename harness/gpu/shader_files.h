// GLSL files by name: live ones from VOLMARK_SHADERS first, then the embedded ones.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace volmark::gpu {

/// Text of "<family>/<file>", or nothing.
std::optional<std::string> findShaderFile(const std::string& path);

/// All embedded names, sorted; for error texts.
std::vector<std::string> embeddedShaderNames();

} // namespace volmark::gpu
