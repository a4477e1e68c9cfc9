#include "volume/volume_file.h"

#include "volmark/error.h"
#include "volume/file_claims.h"
#include "volume/header_text.h"
#include "volume/itk_reader.h"
#include "volume/nrrd.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <utility>

namespace volmark {

namespace {

namespace fs = std::filesystem;

using Loader = std::shared_ptr<const Volume> (*)(const fs::path&, std::uint64_t);

template <ItkFormat format> std::shared_ptr<const Volume> withItk(const fs::path& path, std::uint64_t maximumBytes) {
  return loadWithItk(path, format, maximumBytes);
}

constexpr std::array<std::pair<std::string_view, Loader>, 7> kLoaders = {{{".nrrd", &loadNrrd},
                                                                          {".nhdr", &loadNrrd},
                                                                          {".mha", &withItk<ItkFormat::metaImage>},
                                                                          {".mhd", &withItk<ItkFormat::metaImage>},
                                                                          {".nii", &withItk<ItkFormat::nifti>},
                                                                          {".nii.gz", &withItk<ItkFormat::nifti>},
                                                                          {".vtk", &withItk<ItkFormat::vtk>}}};

Loader loaderOf(const fs::path& path) {
  const std::string name = lowerCase(path.filename().string());
  for (const auto& [ending, loader] : kLoaders)
    if (name.ends_with(ending)) return loader;
  return nullptr;
}

std::string endings() {
  std::vector<std::string_view> list;
  for (const auto& [ending, loader] : kLoaders)
    list.push_back(ending);
  return fmt::format("{}", fmt::join(list, ", "));
}

} // namespace

std::shared_ptr<const Volume> loadVolumeFile(const fs::path& path, std::uint64_t maximumBytes) {
  std::error_code missing;
  const Loader loader = fs::is_directory(path, missing) ? &loadDicomSeries : loaderOf(path);
  if (loader) return loader(path, maximumBytes);
  if (fs::is_regular_file(path, missing) && isDicom(path))
    throw InputError(fmt::format(
        "{}: a single DICOM file, allowed: the folder with its series, and no other series in it", path.string()));
  throw InputError(fmt::format("{}: found a file name that ends in \"{}\", allowed: {}, a folder with a DICOM series, "
                               "or \"raw\" in a scene file that describes its voxels",
                               path.string(), path.extension().string(), endings()));
}

std::shared_ptr<const Volume> loadTimeSeries(const std::vector<fs::path>& paths, std::uint64_t maximumBytes) {
  std::vector<std::byte> voxels;
  std::shared_ptr<const Volume> first;
  for (const fs::path& path : paths) {
    const auto step = loadVolumeFile(path, maximumBytes);
    if (!first) {
      first = step;
      checkedVoxelBytes(path.string(), step->grid(), step->type(), static_cast<int>(paths.size()), maximumBytes);
      voxels = reserveVoxels(path.string(), step->voxels().size() * paths.size());
    }
    const bool alike = step->timeSteps() == 1 && step->type() == first->type() &&
                       step->grid().dims == first->grid().dims && step->grid().spacingMm == first->grid().spacingMm;
    if (!alike)
      throw InputError(fmt::format("{}: its size, spacing, type or time steps are not those of {}", path.string(),
                                   paths.front().filename().string()));
    voxels.insert(voxels.end(), step->voxels().begin(), step->voxels().end());
  }
  if (!first) throw InputError("a time series of no files");
  return std::make_shared<const Volume>(first->name(), first->grid(), first->type(), std::move(voxels),
                                        static_cast<int>(paths.size()), first->notes());
}

bool isVolumeFileName(const fs::path& path) {
  return loaderOf(path) != nullptr;
}

} // namespace volmark
