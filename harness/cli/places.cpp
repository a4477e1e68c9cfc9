#include "cli/commands.h"
#include "volmark/error.h"

#include <fmt/format.h>

#include <cstdlib>
#include <sstream>

namespace volmark {

namespace {

namespace fs = std::filesystem;

constexpr double kMostGib = 1e6;

std::vector<fs::path> splitPaths(const char* text) {
  std::vector<fs::path> result;
  std::istringstream parts(text ? text : "");
  for (std::string part; std::getline(parts, part, ':');)
    if (!part.empty()) result.emplace_back(part);
  return result;
}

/// The folder of the working directory, of the checkout that the program was built in, or of the
/// installation: the first that is there.
fs::path findShared(const std::string& name) {
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const fs::path& candidate :
       {fs::path(name), program / ".." / ".." / name, program / ".." / "share" / "volmark" / name})
    if (fs::is_directory(candidate, ignored)) return candidate.lexically_normal();
  return name;
}

} // namespace

Places findPlaces() {
  Places places;
  const auto own = splitPaths(std::getenv("VOLMARK_SCENES"));
  places.scenes = own.empty() ? findShared("scenes") : own.front();
  places.configs = findShared("configs");
  return places;
}

DataFolders dataFolders(const std::vector<std::string>& options, const Places& places) {
  DataFolders data;
  for (const std::string& option : options)
    data.folders.emplace_back(option);
  for (const fs::path& folder : splitPaths(std::getenv("VOLMARK_DATA")))
    data.folders.push_back(folder);
  data.folders.push_back(places.scenes / "data");
  return data;
}

TechniqueCatalogue loadCatalogue() {
  TechniqueCatalogue catalogue(techniqueFolders());
  for (const std::string& problem : catalogue.problems())
    fmt::print(stderr, "volmark: {}\n", problem);
  return catalogue;
}

std::uint64_t bytesOfGib(double gib) {
  if (!(gib > 0 && gib <= kMostGib))
    throw InputError(fmt::format("--max-volume-gib: found {}, allowed: above 0, up to {}", gib, kMostGib));
  return static_cast<std::uint64_t>(gib * 1024 * 1024 * 1024);
}

} // namespace volmark
