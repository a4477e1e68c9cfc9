// Opens a volume file by its name.
#pragma once

#include "volmark/volume.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace volmark {

/// ".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz", ".vtk", or a folder with a DICOM series. What had to be decoded
/// is cached (volume_cache.h); uncompressed voxels of this machine's byte order are mapped from the file itself.
/// Throws InputError: another name, a header or a length that is wrong, over `maximumBytes`.
std::shared_ptr<const Volume> loadVolumeFile(const std::filesystem::path& path, std::uint64_t maximumBytes);

/// Several files as the time steps of one volume, in this order; sizes, spacings and types must be equal.
/// Throws InputError.
std::shared_ptr<const Volume> loadTimeSeries(const std::vector<std::filesystem::path>& paths,
                                             std::uint64_t maximumBytes);

/// Whether the name ends like a volume file's.
bool isVolumeFileName(const std::filesystem::path& path);

} // namespace volmark
