// What the headers of other formats claim, read by our own eyes before a library gets the file: sizes are held
// against the file's length and the limit, so that no header makes a library allocate or read what isn't there.
#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace volmark {

/// A claim that was checked: the file holds these voxels.
struct FileClaim {
  glm::ivec3 dims{1};
  int timeSteps = 1;
  std::size_t scalarBytes = 1;

  std::uint64_t bytes() const {
    return std::uint64_t(dims.x) * std::uint64_t(dims.y) * std::uint64_t(dims.z) * std::uint64_t(timeSteps) *
           scalarBytes;
  }
};

// Each reads at most 64 KiB of header, and all of a compressed file's voxels to see that they are as many as
// claimed, without keeping them. Each throws InputError: not that format, a field that is missing or out of range,
// more than one value per voxel, a length that is not the file's, over `maximumBytes`.

/// MetaImage: .mha, or .mhd with one data file beside it; uncompressed or zlib.
FileClaim checkMetaImage(const std::filesystem::path& path, std::uint64_t maximumBytes);
/// The file with the voxels, `path` itself if they follow the header.
std::filesystem::path metaImageDataFile(const std::filesystem::path& path);
/// NIfTI-1 in one file: .nii, .nii.gz; 3-D, or 4-D with time.
FileClaim checkNifti(const std::filesystem::path& path, std::uint64_t maximumBytes);
/// Legacy VTK, binary STRUCTURED_POINTS with one scalar a point: .vtk.
FileClaim checkVtk(const std::filesystem::path& path, std::uint64_t maximumBytes);

/// One slice of a DICOM series.
struct DicomClaim {
  FileClaim slice;
  std::string series; ///< SeriesInstanceUID
};
/// Whether the file starts as DICOM files do ("DICM" after 128 bytes).
bool isDicom(const std::filesystem::path& path);
/// A grey-scale picture in one frame, uncompressed or with the compressions that gdcm reads. Sequences are skipped, at
/// most 16 deep; pieces of compressed pixels are held against the file's length.
DicomClaim checkDicom(const std::filesystem::path& path, std::uint64_t maximumBytes);

/// Throws InputError, prefixed with `place`, if the claim is empty, overflows or is over the limit.
void checkClaimedSize(const std::string& place, const FileClaim& claim, std::uint64_t maximumBytes);

} // namespace volmark
