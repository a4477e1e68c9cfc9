// From a scene's source to a volume in memory.
#include "scenario/scene_file.h"
#include "volmark/error.h"
#include "volume/nrrd.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>

namespace volmark {

namespace {

/// Empty for a generated volume.
std::string fileOf(const SceneDescription& scene) {
  if (const auto* file = std::get_if<FileSource>(&scene.source)) return file->file;
  if (const auto* raw = std::get_if<RawSource>(&scene.source)) return raw->file;
  return {};
}

/// Beside the scene file, then the data folders. A bare volume file is where its path says.
std::vector<std::filesystem::path> foldersOf(const SceneDescription& scene, const DataFolders& data) {
  std::vector<std::filesystem::path> folders = {scene.path.parent_path()};
  if (!scene.path.empty()) folders.insert(folders.end(), data.folders.begin(), data.folders.end());
  return folders;
}

std::filesystem::path requireVolumeFile(const SceneDescription& scene, const DataFolders& data) {
  if (const auto found = findVolumeFile(scene, data)) return *found;
  std::vector<std::string> folders;
  for (const std::filesystem::path& folder : foldersOf(scene, data))
    folders.push_back(folder.empty() ? "." : folder.string());
  const std::string hint = scene.fetchHint.empty() ? "" : fmt::format("; to get it: {}", scene.fetchHint);
  throw InputError(
      fmt::format("scene {}: there is no {} in {}{}", scene.name, fileOf(scene), fmt::join(folders, ", "), hint));
}

std::shared_ptr<const Volume> loadFile(const std::filesystem::path& path, std::uint64_t maximumBytes) {
  const std::string extension = path.extension().string();
  if (extension == ".nrrd" || extension == ".nhdr") return loadNrrd(path, maximumBytes);
  throw InputError(
      fmt::format("{}: found a file name that ends in \"{}\", allowed: .nrrd, .nhdr, or \"raw\" in a scene "
                  "file that describes its voxels",
                  path.string(), extension));
}

} // namespace

std::optional<std::filesystem::path> findVolumeFile(const SceneDescription& scene, const DataFolders& data) {
  const std::string file = fileOf(scene);
  if (file.empty()) return std::nullopt;
  for (const std::filesystem::path& folder : foldersOf(scene, data)) {
    // An absolute file name replaces the folder.
    const std::filesystem::path candidate = folder / file;
    std::error_code error;
    if (std::filesystem::exists(candidate, error)) return candidate;
  }
  return std::nullopt;
}

std::shared_ptr<const Volume> openVolume(const SceneDescription& scene, const DataFolders& data,
                                         std::uint64_t maximumBytes) {
  if (const auto* generator = std::get_if<GeneratorSource>(&scene.source)) {
    const GeneratorSettings& settings = generator->settings;
    checkedVoxelBytes(fmt::format("scene {}", scene.name), {settings.dims, settings.spacingMm}, settings.type,
                      timeStepsOf(settings), maximumBytes);
    return generateVolume(settings);
  }
  const std::filesystem::path path = requireVolumeFile(scene, data);
  if (const auto* raw = std::get_if<RawSource>(&scene.source)) return loadRaw(path, raw->description, maximumBytes);
  return loadFile(path, maximumBytes);
}

} // namespace volmark
