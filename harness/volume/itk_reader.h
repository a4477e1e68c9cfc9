// MetaImage, NIfTI, DICOM series and legacy VTK images, through ITK.
//
// NRRD stays with our own reader (nrrd.h): it needs no library, so the project works without ITK, and its voxels
// are decoded once, straight to where they stay. Built without ITK, these functions throw InputError and say so.
#pragma once

#include "volmark/volume.h"

#include <filesystem>
#include <memory>

namespace volmark {

enum class ItkFormat { metaImage, nifti, vtk };

/// Turned to patient axes (orientation.h); 8- and 16-bit integers and float32 keep their type, wider types become
/// float32 with a note. NIfTI's scaling is applied (the values are float32 then). The file is checked first
/// (file_claims.h). Throws InputError.
std::shared_ptr<const Volume> loadWithItk(const std::filesystem::path& path, ItkFormat format,
                                          std::uint64_t maximumBytes);

/// All DICOM files of a folder (not of folders in it), one slice each, which must be one series: ordered by their
/// place along the slices' normal, with slope and intercept applied. Spacing along z is the slices' mean distance;
/// uneven distances and a tilted gantry are noted, two slices in one place are refused. Throws InputError.
std::shared_ptr<const Volume> loadDicomSeries(const std::filesystem::path& folder, std::uint64_t maximumBytes);

} // namespace volmark
