// The process environment that graphics drivers read, and volmark's cache folder.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace volmark::gpu {

/// $VOLMARK_CACHE, else $XDG_CACHE_HOME/volmark, else ~/.cache/volmark, else a folder of the user in the
/// system's temporary folder. It need not exist yet.
std::filesystem::path cacheFolder();

/// Sets what Mesa's drivers need for right and repeatable results, unless the user has set it: lavapipe's
/// vector width (LP_NATIVE_VECTOR_WIDTH=256; wider vectors give wrong pictures), and a shader cache of our own
/// for each driver version and width (MESA_SHADER_CACHE_DIR), because Mesa's is not keyed on the width. Runs
/// once; listDevices() and Device call it. Call it before the first thread starts: it writes the environment.
void prepareDriverEnvironment();

/// Variables that drivers and loader read (LP_*, MESA_*, VK_*, GALLIUM_*), sorted by name, as they are now.
std::vector<std::pair<std::string, std::string>> driverEnvironment();

} // namespace volmark::gpu
