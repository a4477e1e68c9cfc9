// Headerless volumes, described by a scene file.
#pragma once

#include "volmark/volume.h"

#include <filesystem>
#include <memory>

namespace volmark {

struct RawDescription {
  Grid grid;
  ScalarType type = ScalarType::uint8;
  bool bigEndian = false;
  std::uint64_t offsetBytes = 0;
  int timeSteps = 1;
};

/// Throws InputError when the file is missing or its length is not offset + the described voxels, before
/// anything is allocated.
std::shared_ptr<const Volume> loadRaw(const std::filesystem::path& path, const RawDescription& description,
                                      std::uint64_t maximumBytes);

} // namespace volmark
