// GLSL to SPIR-V, in process, with includes and a cache on disk.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace volmark::gpu {

/// One embedded GLSL file; `path` is what #include and ShaderSource name: "<family>/<file>", or
/// "volmark/<file>" for the SDK's own.
struct EmbeddedShader {
  const char* path;
  const char* text;
};

/// Makes files known to the compiler. Called by the loader for each module; `files` must stay alive.
void registerShaders(std::span<const EmbeddedShader> files);

struct ShaderSource {
  std::string path; ///< "<family>/<file>"
  VkShaderStageFlagBits stage = VK_SHADER_STAGE_COMPUTE_BIT;
  std::vector<std::pair<std::string, std::string>> macros; ///< only where types or array sizes change
};

/// SPIR-V 1.6 for Vulkan 1.3, entry point "main". Files are searched first in the folders of the
/// environment variable VOLMARK_SHADERS (separated by ':'; live editing), then among the embedded ones.
/// Results are kept in $VOLMARK_CACHE/spirv (default: $XDG_CACHE_HOME/volmark or ~/.cache/volmark), keyed by
/// the preprocessed text, stage and compiler version; an unusable cache only costs time.
/// Throws InputError with glslang's message, one line per error, file names and line numbers as written.
std::vector<std::uint32_t> compileShader(const ShaderSource& source);

} // namespace volmark::gpu
