// What all file readers of this folder share: lengths, limits, bytes and byte order.
#pragma once

#include "volmark/volume.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace volmark {

/// Length of a regular file in bytes. Throws InputError if it is missing or something else (a folder, a pipe).
std::uint64_t fileLength(const std::filesystem::path& path);

/// Decoded size of the described voxels. Throws InputError, prefixed with `place`, if a dimension is below 1,
/// the product overflows or it is over `maximumBytes`.
std::uint64_t checkedVoxelBytes(const std::string& place, const Grid& grid, ScalarType type, int timeSteps,
                                std::uint64_t maximumBytes);

/// `count` bytes of zero. Throws InputError, prefixed with `place`, if there isn't the memory.
std::vector<std::byte> allocateVoxels(const std::string& place, std::uint64_t count);

/// Empty, with room for `count` bytes, which take memory only once they are there: for counts that a file claims and
/// may not keep. Throws InputError as above.
std::vector<std::byte> reserveVoxels(const std::string& place, std::uint64_t count);

/// Bytes [offset, offset + count) of a file. Throws InputError if they can't be read.
std::vector<std::byte> readVoxels(const std::filesystem::path& path, std::uint64_t offset, std::uint64_t count);

/// Whether scalars of this byte order can be used as they are.
bool isNativeOrder(ScalarType type, bool bigEndian);

/// Swaps the bytes of every scalar unless `bigEndian` is this machine's order.
void toNativeOrder(std::span<std::byte> voxels, ScalarType type, bool bigEndian);

} // namespace volmark
