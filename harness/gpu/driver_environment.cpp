#include "volmark/gpu/driver_environment.h"

#include "gpu/instance.h"
#include "volmark/gpu/device.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <unistd.h>

extern char** environ;

namespace volmark::gpu {

namespace {

/// The value of a variable, or "" if it is unset or empty.
std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// Names and versions of all drivers that the loader finds.
std::string installedDrivers() {
  std::string text;
  try {
    const Instance probe(nullptr);
    for (const VkPhysicalDevice device : probe.physicalDevices()) {
      VkPhysicalDeviceProperties base;
      vkGetPhysicalDeviceProperties(device, &base);
      if (base.apiVersion < VK_API_VERSION_1_2) continue; // tells no driver version, and volmark can't use it
      VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
      VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &driver};
      vkGetPhysicalDeviceProperties2(device, &properties);
      text += fmt::format("{}{} {}", text.empty() ? "" : "+", driver.driverName, driver.driverInfo);
    }
  } catch (const std::runtime_error&) {
    // The caller's own instance reports what is wrong.
  }
  return text;
}

/// Letters, digits, dots and dashes only.
std::string asFileName(std::string text) {
  for (char& c : text)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.') c = '-';
  return text.substr(0, 100);
}

void chooseShaderCache() {
  if (!variable("MESA_SHADER_CACHE_DIR").empty()) return;
  const std::filesystem::path root = cacheFolder();
  // The probe must not touch the user's own cache either.
  setenv("MESA_SHADER_CACHE_DIR", root.c_str(), 1);
  const std::string key = fmt::format("mesa-{}-{}", asFileName(installedDrivers()), variable("LP_NATIVE_VECTOR_WIDTH"));
  const std::filesystem::path folder = root / key;
  std::error_code ignored; // Mesa works without a cache
  std::filesystem::create_directories(folder, ignored);
  setenv("MESA_SHADER_CACHE_DIR", folder.c_str(), 1);
}

} // namespace

std::filesystem::path cacheFolder() {
  if (const std::string own = variable("VOLMARK_CACHE"); !own.empty()) return own;
  if (const std::string xdg = variable("XDG_CACHE_HOME"); !xdg.empty()) return std::filesystem::path(xdg) / "volmark";
  if (const std::string home = variable("HOME"); !home.empty())
    return std::filesystem::path(home) / ".cache" / "volmark";
  return std::filesystem::temp_directory_path() / fmt::format("volmark-{}", getuid());
}

void prepareDriverEnvironment() {
  static std::once_flag once;
  std::call_once(once, [] {
    setenv("LP_NATIVE_VECTOR_WIDTH", "256", 0);
    chooseShaderCache();
  });
}

std::vector<std::pair<std::string, std::string>> driverEnvironment() {
  constexpr std::string_view prefixes[] = {"LP_", "MESA_", "VK_", "GALLIUM_"};
  std::vector<std::pair<std::string, std::string>> result;
  for (char** entry = environ; *entry; ++entry) {
    const std::string_view text(*entry);
    const std::size_t equals = text.find('=');
    const bool relevant = std::any_of(std::begin(prefixes), std::end(prefixes),
                                      [&](std::string_view prefix) { return text.starts_with(prefix); });
    if (relevant && equals != std::string_view::npos)
      result.emplace_back(text.substr(0, equals), text.substr(equals + 1));
  }
  std::sort(result.begin(), result.end());
  return result;
}

} // namespace volmark::gpu
