#include "volume/voxel_file.h"

#include "volmark/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <limits>
#include <new>
#include <system_error>

namespace volmark {

std::uint64_t fileLength(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw InputError(fmt::format("{}: no such file", path.string()));
  // Opening a pipe would wait for ever.
  if (!std::filesystem::is_regular_file(status)) throw InputError(fmt::format("{}: not a regular file", path.string()));
  const std::uintmax_t length = std::filesystem::file_size(path, error);
  if (error) throw InputError(fmt::format("{}: {}", path.string(), error.message()));
  return length;
}

std::uint64_t checkedVoxelBytes(const std::string& place, const Grid& grid, ScalarType type, int timeSteps,
                                std::uint64_t maximumBytes) {
  const std::string described = fmt::format("{} x {} x {} voxels of {}, {} time step{}", grid.dims.x, grid.dims.y,
                                            grid.dims.z, nameOf(type), timeSteps, timeSteps == 1 ? "" : "s");
  std::uint64_t bytes = sizeOf(type);
  for (const int count : {grid.dims.x, grid.dims.y, grid.dims.z, timeSteps}) {
    if (count < 1) throw InputError(fmt::format("{}: found {}, allowed: at least 1 of each", place, described));
    const auto factor = static_cast<std::uint64_t>(count);
    if (bytes > std::numeric_limits<std::uint64_t>::max() / factor)
      throw InputError(fmt::format("{}: found {}, allowed: {} bytes", place, described, maximumBytes));
    bytes *= factor;
  }
  if (bytes > maximumBytes)
    throw InputError(fmt::format("{}: found {} ({} bytes), allowed: {} bytes", place, described, bytes, maximumBytes));
  return bytes;
}

std::vector<std::byte> allocateVoxels(const std::string& place, std::uint64_t count) {
  std::vector<std::byte> voxels = reserveVoxels(place, count);
  voxels.resize(count);
  return voxels;
}

std::vector<std::byte> reserveVoxels(const std::string& place, std::uint64_t count) {
  std::vector<std::byte> voxels;
  try {
    voxels.reserve(count);
  } catch (const std::exception&) { // bad_alloc or length_error
    throw InputError(fmt::format("{}: no memory for {} bytes of voxels", place, count));
  }
  return voxels;
}

std::vector<std::byte> readVoxels(const std::filesystem::path& path, std::uint64_t offset, std::uint64_t count) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: can't be opened", path.string()));
  std::vector<std::byte> voxels = allocateVoxels(path.string(), count);
  file.seekg(static_cast<std::streamoff>(offset));
  file.read(reinterpret_cast<char*>(voxels.data()), static_cast<std::streamsize>(count));
  if (!file) throw InputError(fmt::format("{}: {} bytes at {} can't be read", path.string(), count, offset));
  return voxels;
}

bool isNativeOrder(ScalarType type, bool bigEndian) {
  return sizeOf(type) == 1 || bigEndian == (std::endian::native == std::endian::big);
}

void toNativeOrder(std::span<std::byte> voxels, ScalarType type, bool bigEndian) {
  if (isNativeOrder(type, bigEndian)) return;
  const std::size_t size = sizeOf(type);
  for (std::size_t i = 0; i + size <= voxels.size(); i += size)
    std::reverse(voxels.begin() + static_cast<std::ptrdiff_t>(i),
                 voxels.begin() + static_cast<std::ptrdiff_t>(i + size));
}

} // namespace volmark
