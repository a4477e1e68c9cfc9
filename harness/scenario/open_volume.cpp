// From a scene's source to a volume in memory.
#include "scenario/scene_file.h"
#include "volmark/error.h"
#include "volume/volume_file.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <fnmatch.h>

namespace volmark {

namespace {

namespace fs = std::filesystem;

/// Empty for a generated volume.
std::vector<std::string> filesOf(const SceneDescription& scene) {
  if (const auto* file = std::get_if<FileSource>(&scene.source)) return {file->file};
  if (const auto* raw = std::get_if<RawSource>(&scene.source)) return {raw->file};
  if (const auto* mesh = std::get_if<MeshSource>(&scene.source)) return {mesh->file};
  if (const auto* series = std::get_if<SeriesSource>(&scene.source)) return series->files;
  return {};
}

/// Beside the scene file, then the data folders. A bare volume file is where its path says.
std::vector<fs::path> foldersOf(const SceneDescription& scene, const DataFolders& data) {
  std::vector<fs::path> folders = {scene.path.parent_path()};
  if (!scene.path.empty()) folders.insert(folders.end(), data.folders.begin(), data.folders.end());
  return folders;
}

/// What stands for `file` in one folder: itself, or the files that its "*" stands for, in natural order.
std::vector<fs::path> matches(const fs::path& folder, const std::string& file) {
  // An absolute file name replaces the folder.
  const fs::path whole = folder / file;
  std::error_code error;
  if (file.find('*') == std::string::npos)
    return fs::exists(whole, error) ? std::vector{whole} : std::vector<fs::path>{};
  const std::string pattern = whole.filename().string();
  std::vector<fs::path> found;
  const fs::path place = whole.parent_path();
  for (const auto& entry : fs::directory_iterator(place.empty() ? "." : place, error))
    if (::fnmatch(pattern.c_str(), entry.path().filename().c_str(), FNM_PERIOD) == 0) found.push_back(entry.path());
  // By numbers: step_2 comes before step_10.
  std::sort(found.begin(), found.end(),
            [](const fs::path& a, const fs::path& b) { return ::strverscmp(a.c_str(), b.c_str()) < 0; });
  return found;
}

std::vector<fs::path> requireVolumeFiles(const SceneDescription& scene, const DataFolders& data) {
  std::vector<fs::path> all;
  for (const std::string& file : filesOf(scene)) {
    std::vector<fs::path> found;
    for (const fs::path& folder : foldersOf(scene, data))
      if (found.empty()) found = matches(folder, file);
    if (found.empty()) {
      std::vector<std::string> folders;
      for (const fs::path& folder : foldersOf(scene, data))
        folders.push_back(folder.empty() ? "." : folder.string());
      const std::string hint = scene.fetchHint.empty() ? "" : fmt::format("; to get it: {}", scene.fetchHint);
      throw InputError(
          fmt::format("scene {}: there is no {} in {}{}", scene.name, file, fmt::join(folders, ", "), hint));
    }
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

} // namespace

std::optional<fs::path> findVolumeFile(const SceneDescription& scene, const DataFolders& data) {
  for (const std::string& file : filesOf(scene))
    for (const fs::path& folder : foldersOf(scene, data))
      if (const auto found = matches(folder, file); !found.empty()) return found.front();
  return std::nullopt;
}

namespace {

std::shared_ptr<const Volume> openScalars(const SceneDescription& scene, const DataFolders& data,
                                          std::uint64_t maximumBytes) {
  if (const auto* generator = std::get_if<GeneratorSource>(&scene.source)) {
    const GeneratorSettings& settings = generator->settings;
    checkedVoxelBytes(fmt::format("scene {}", scene.name), {settings.dims, settings.spacingMm}, settings.type,
                      timeStepsOf(settings), maximumBytes);
    return generateVolume(settings);
  }
  const std::vector<fs::path> files = requireVolumeFiles(scene, data);
  if (const auto* raw = std::get_if<RawSource>(&scene.source))
    return loadRaw(files.front(), raw->description, maximumBytes);
  if (const auto* mesh = std::get_if<MeshSource>(&scene.source))
    return loadMesh(files.front(), mesh->settings, maximumBytes);
  if (std::holds_alternative<SeriesSource>(scene.source)) return loadTimeSeries(files, maximumBytes);
  return loadVolumeFile(files.front(), maximumBytes);
}

/// The labels as a scene of their own.
SceneDescription sceneOfLabels(const SceneDescription& scene) {
  SceneDescription labels = scene;
  labels.labels.reset();
  if (scene.labels->generator.empty()) {
    labels.source = FileSource{scene.labels->file};
  } else {
    GeneratorSettings& settings = std::get<GeneratorSource>(labels.source).settings;
    settings.name = scene.labels->generator;
    settings.type = ScalarType::uint8;
  }
  return labels;
}

} // namespace

std::shared_ptr<const Volume> openVolume(const SceneDescription& scene, const DataFolders& data,
                                         std::uint64_t maximumBytes) {
  auto volume = openScalars(scene, data, maximumBytes);
  if (!scene.labels) return volume;
  return std::make_shared<const Volume>(volume->withLabels(openScalars(sceneOfLabels(scene), data, maximumBytes)));
}

} // namespace volmark
