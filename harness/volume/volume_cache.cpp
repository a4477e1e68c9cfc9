#include "volume/volume_cache.h"

#include "volmark/error.h"
#include "volmark/gpu/driver_environment.h"
#include "volume/mapped_file.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

namespace volmark {

namespace {

namespace fs = std::filesystem;

/// Also to be raised when a reader changes what it makes of the same file.
constexpr int kFormat = 2;
constexpr std::size_t kHeadBytes = 4096; // a page, so that voxels are aligned
constexpr double kDefaultGib = 32;
constexpr std::uint64_t kLeastBytes = 1u << 20;
constexpr std::time_t kSettledSeconds = 2;
constexpr std::chrono::minutes kLongestWriting{10}; // without a byte written

fs::path folder() {
  return gpu::cacheFolder() / "volumes";
}

fs::path fileOf(const std::string& key) {
  const std::string text = fmt::format("{} {}", kFormat, key);
  const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
  return folder() / fmt::format("{:016x}{:016x}.voxels", hash.high64, hash.low64);
}

nlohmann::json headOf(const Volume& volume) {
  const Grid& grid = volume.grid();
  return {{"volmark_voxels", kFormat},
          {"name", volume.name()},
          {"type", nameOf(volume.type())},
          {"dims", {grid.dims.x, grid.dims.y, grid.dims.z}},
          {"spacing_mm", {grid.spacingMm.x, grid.spacingMm.y, grid.spacingMm.z}},
          {"time_steps", volume.timeSteps()},
          {"notes", volume.notes()},
          {"identity", volume.identity()}};
}

/// Nothing if there is no such file or it isn't whole.
std::shared_ptr<const Volume> find(const fs::path& path) {
  std::error_code missing;
  if (!fs::exists(path, missing)) return nullptr;
  try {
    const SharedBytes all = mapFile(path, 0);
    if (all.view().size() < kHeadBytes) return nullptr;
    const auto* text = reinterpret_cast<const char*>(all.view().data());
    const auto head = nlohmann::json::parse(text, text + strnlen(text, kHeadBytes));
    Grid grid;
    for (int axis = 0; axis < 3; ++axis) {
      grid.dims[axis] = head.at("dims").at(static_cast<std::size_t>(axis)).get<int>();
      grid.spacingMm[axis] = head.at("spacing_mm").at(static_cast<std::size_t>(axis)).get<double>();
    }
    auto volume = std::make_shared<const Volume>(
        head.at("name").get<std::string>(), grid, scalarTypeFromName(head.at("type").get<std::string>()),
        mapFile(path, kHeadBytes), head.at("time_steps").get<int>(), head.at("notes").get<std::vector<std::string>>());
    return volume->identity() == head.at("identity").get<std::string>() ? volume : nullptr;
  } catch (const std::exception&) {
    return nullptr; // it is written anew
  }
}

/// Removes the files used longest ago until `bytes` more fit, and what was never finished.
void makeRoom(std::uint64_t bytes, std::uint64_t limit) {
  struct Entry {
    fs::file_time_type used;
    fs::path path;
    std::uint64_t bytes;
  };
  std::vector<Entry> entries;
  std::uint64_t total = bytes;
  std::error_code ignored;
  for (const auto& file : fs::directory_iterator(folder(), ignored)) {
    if (file.path().extension() != ".voxels") {
      // Somebody is writing it, or was killed while he did.
      std::error_code gone;
      const fs::file_time_type written = file.last_write_time(gone);
      if (!gone && fs::file_time_type::clock::now() - written > kLongestWriting) fs::remove(file.path(), ignored);
      continue;
    }
    entries.push_back({file.last_write_time(ignored), file.path(), file.file_size(ignored)});
    total += entries.back().bytes;
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.used < b.used; });
  for (const Entry& entry : entries) {
    if (total <= limit) return;
    fs::remove(entry.path, ignored); // whoever has it mapped keeps it
    total -= entry.bytes;
  }
}

void store(const fs::path& path, const Volume& volume) {
  const std::uint64_t bytes = kHeadBytes + volume.voxels().size() * static_cast<std::uint64_t>(volume.timeSteps());
  const std::uint64_t limit = volumeCacheBytes();
  std::string head = headOf(volume).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (bytes > limit || head.size() >= kHeadBytes) return;
  head.resize(kHeadBytes, '\0');
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  makeRoom(bytes, limit);
  const fs::path temporary = fmt::format("{}.{}", path.string(), ::getpid());
  std::ofstream file(temporary, std::ios::binary);
  file.write(head.data(), static_cast<std::streamsize>(head.size()));
  for (int step = 0; step < volume.timeSteps(); ++step) {
    const auto voxels = volume.voxels(step);
    file.write(reinterpret_cast<const char*>(voxels.data()), static_cast<std::streamsize>(voxels.size()));
  }
  file.close();
  if (file) fs::rename(temporary, path, error);
  if (!file || error) fs::remove(temporary, error);
}

/// Adds what identifies a file's content. False if its next change could have the same stamp.
bool addStamp(const fs::path& path, std::string& key) {
  struct stat status {};
  std::error_code error;
  const fs::path whole = fs::canonical(path, error);
  if (error || ::stat(path.c_str(), &status) != 0) return false;
  key += fmt::format("\n{} {} {} {}.{:09}", whole.string(), status.st_ino, status.st_size, status.st_mtim.tv_sec,
                     status.st_mtim.tv_nsec);
  return std::time(nullptr) - status.st_mtim.tv_sec > kSettledSeconds;
}

} // namespace

std::uint64_t volumeCacheBytes() {
  const char* text = std::getenv("VOLMARK_VOLUME_CACHE_GIB");
  double gib = kDefaultGib;
  if (text && *text) {
    const auto [end, error] = std::from_chars(text, text + std::strlen(text), gib);
    if (error != std::errc() || *end != '\0' || !(gib >= 0 && gib <= 1e6))
      throw InputError(fmt::format("VOLMARK_VOLUME_CACHE_GIB: found \"{}\", allowed: 0 to 1000000", text));
  }
  return static_cast<std::uint64_t>(gib * (1u << 30));
}

std::shared_ptr<const Volume> cachedVolume(const std::vector<fs::path>& sources, const std::string& settings,
                                           std::uint64_t maximumBytes,
                                           const std::function<std::shared_ptr<const Volume>()>& decode) {
  if (volumeCacheBytes() == 0) return decode();
  std::string key = settings;
  bool settled = true;
  for (const fs::path& source : sources)
    settled = addStamp(source, key) && settled;
  const fs::path path = fileOf(key);
  if (auto found = find(path)) {
    checkedVoxelBytes(found->name(), found->grid(), found->type(), found->timeSteps(), maximumBytes);
    std::error_code ignored;
    fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);
    return found;
  }
  const auto volume = decode();
  if (!settled || volume->voxels().size() * static_cast<std::uint64_t>(volume->timeSteps()) < kLeastBytes)
    return volume;
  store(path, *volume);
  // Mapped, it is shared with the other processes that open it.
  if (auto stored = find(path)) return stored;
  return volume;
}

} // namespace volmark
