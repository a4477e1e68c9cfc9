// NRRD (NRRD0001 to NRRD0005): attached and detached headers, raw and gzip encoding, int8/16, uint8/16 and
// float, both byte orders, 3-D (and 4-D with time as the slowest axis).
#pragma once

#include "volmark/volume.h"

#include <filesystem>
#include <memory>
#include <string>

namespace volmark {

/// Spacings are those of the header or the lengths of its space directions; an unknown one (NaN or absent) is
/// 1. The origin is not used.
struct NrrdHeader {
  Grid grid;
  ScalarType type = ScalarType::uint8;
  bool bigEndian = false;
  bool gzip = false;
  int timeSteps = 1;
  glm::dmat3 directions{1.0};     ///< columns: unit vectors of the file's axes in LPS; NaN if a length is unknown
  std::filesystem::path dataFile; ///< the header's own file if attached
  std::uint64_t dataOffset = 0;   ///< where encoded voxels start in dataFile
  std::uint64_t skippedBytes = 0; ///< gzip only: decoded bytes before the first voxel

  std::uint64_t voxelBytes() const; ///< decoded size that the header declares
};

/// Reads and checks the header only (at most 64 KiB), against the file's length and the limit, before any
/// allocation of the declared size. Throws InputError.
NrrdHeader readNrrdHeader(const std::filesystem::path& path, std::uint64_t maximumBytes);

/// Turned to patient axes (orientation.h). Throws InputError; a gzip stream that is longer or shorter than
/// declared is refused.
std::shared_ptr<const Volume> loadNrrd(const std::filesystem::path& path, std::uint64_t maximumBytes);

} // namespace volmark
