// A library decodes a file in a process of its own.
#pragma once

#include "volmark/volume.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace volmark {

/// A volume in the making.
struct DecodedVolume {
  std::string name;
  Grid grid;
  ScalarType type = ScalarType::uint8;
  int timeSteps = 1;
  std::vector<std::byte> voxels;
  std::vector<std::string> notes;
};

/// Calls `decode` in a child process and returns what it returned; an InputError of it is thrown here. Image libraries
/// are large and believe their files: where one stops the process, prints, runs on for ever or asks for far more memory
/// than `claimedBytes` of voxels need, that is one InputError, prefixed with `path`. Throws DeviceError without a
/// process.
std::shared_ptr<const Volume> decodeApart(const std::filesystem::path& path, std::uint64_t claimedBytes,
                                          const std::function<DecodedVolume()>& decode);

} // namespace volmark
