#include "technique/module_file.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <dlfcn.h>
#include <fstream>
#include <string_view>

namespace volmark {

namespace {

std::string oneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// Empty if the file can't be read.
std::string digestOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return "";
  XXH3_state_t* state = XXH3_createState();
  XXH3_128bits_reset(state);
  std::array<char, 1 << 16> block;
  while (stream.read(block.data(), block.size()) || stream.gcount() > 0)
    XXH3_128bits_update(state, block.data(), static_cast<std::size_t>(stream.gcount()));
  const XXH128_hash_t hash = XXH3_128bits_digest(state);
  XXH3_freeState(state);
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

/// Reads only the members up to `buildId`: the layout of the rest is known once these agree.
std::optional<std::string> mismatch(const ModuleDescription& module) {
  if (module.magic != kModuleMagic)
    return fmt::format("found module format {:#010x}, expected {:#010x}", module.magic, kModuleMagic);
  const struct {
    const char* what;
    const char* found;
    const char* expected;
  } checks[] = {{"SDK version", module.sdkVersion, kSdkVersion},
                {"compiler", module.compiler, kCompiler},
                {"SDK build", module.buildId, kBuildId}};
  for (const auto& check : checks)
    if (!check.found || std::string_view(check.found) != check.expected)
      return fmt::format("built for {} \"{}\", expected \"{}\": rebuild the module against this volmark", check.what,
                         check.found ? oneLine(check.found) : "", check.expected);
  return std::nullopt;
}

} // namespace

std::pair<std::optional<OpenModule>, std::string> openModule(const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& why) {
    return std::pair(std::optional<OpenModule>(), fmt::format("{}: {}", file.string(), oneLine(why)));
  };
  // An absolute path keeps dlopen from searching the system's folders.
  void* handle = dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) return refuse(fmt::format("can't be loaded: {}", dlerror()));
  using Entry = const ModuleDescription* (*)();
  const auto entry = reinterpret_cast<Entry>(dlsym(handle, "volmarkModule"));
  if (!entry) return refuse("no technique module: found no function volmarkModule, expected one (VOLMARK_MODULE)");
  const ModuleDescription* description = entry();
  if (!description) return refuse("volmarkModule returned nothing");
  if (const auto why = mismatch(*description)) return refuse(*why);
  gpu::registerShaders(description->shaders);
  return {OpenModule{description, digestOf(file)}, ""};
}

} // namespace volmark
