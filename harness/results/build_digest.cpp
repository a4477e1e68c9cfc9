#include "results/hash.h"
#include "results/provenance.h"
#include "volmark/error.h"
#include "volmark/parameters.h"

#include <fmt/format.h>

#include <cstdint>
#include <dlfcn.h>
#include <filesystem>
#include <fstream>

namespace volmark {

namespace {

std::string fileDigest(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::string bytes(error ? 0 : size, '\0');
  std::ifstream file(path, std::ios::binary);
  if (bytes.empty() || !file.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
    throw DeviceError(fmt::format("{}: can't be read for the build's digest", path.string()));
  return digestOf(bytes);
}

// Where libvolmark was loaded from: it has this function. The program itself if it is linked in statically.
std::filesystem::path libraryPath() {
  Dl_info info{};
  const void* function = reinterpret_cast<const void*>(&typeNameOf);
  if (dladdr(function, &info) == 0 || !info.dli_fname || !std::filesystem::exists(info.dli_fname))
    return "/proc/self/exe";
  return info.dli_fname;
}

} // namespace

std::string buildDigest(const std::string& moduleDigest) {
  static const std::string program = fileDigest("/proc/self/exe") + fileDigest(libraryPath());
  return digestOf(program + moduleDigest);
}

} // namespace volmark
