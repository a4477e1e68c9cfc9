// Inputs of the microbenchmarks, made once per process.
#pragma once

#include "volmark/picture.h"
#include "volmark/volume.h"

#include <filesystem>
#include <memory>
#include <string>

namespace volmark::bench {

/// A folder of this process, gone at its end.
const std::filesystem::path& folder();

/// Marschner-Lobb, uint8, `side`^3 voxels.
std::shared_ptr<const Volume> volume(int side);

/// The same voxels as a file of the ending (".nrrd", ".nrrd gzip", ".mha", ".nii", ".nii.gz", ".raw"), older than what
/// the volume cache calls settled, which is switched off.
std::filesystem::path volumeFile(const std::string& form, int side);

/// Smooth colours with distances; `seed` changes them a little.
Picture picture(int width, int height, double seed);

} // namespace volmark::bench
