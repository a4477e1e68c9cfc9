#include "volume/raw.h"

#include "volmark/error.h"
#include "volume/mapped_file.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>

namespace volmark {

std::shared_ptr<const Volume> loadRaw(const std::filesystem::path& path, const RawDescription& description,
                                      std::uint64_t maximumBytes) {
  const std::uint64_t length = fileLength(path);
  const std::uint64_t bytes =
      checkedVoxelBytes(path.string(), description.grid, description.type, description.timeSteps, maximumBytes);
  if (description.offsetBytes > length || length - description.offsetBytes != bytes)
    throw InputError(fmt::format("{}: the file has {} bytes, expected {} bytes of voxels after {} skipped",
                                 path.string(), length, bytes, description.offsetBytes));
  const auto volume = [&](SharedBytes voxels) {
    return std::make_shared<const Volume>(path.filename().string(), description.grid, description.type,
                                          std::move(voxels), description.timeSteps);
  };
  const bool usableAsIs =
      isNativeOrder(description.type, description.bigEndian) && description.offsetBytes % sizeOf(description.type) == 0;
  if (usableAsIs) return volume(mapFile(path, description.offsetBytes));
  std::vector<std::byte> voxels = readVoxels(path, description.offsetBytes, bytes);
  toNativeOrder(voxels, description.type, description.bigEndian);
  return volume(std::move(voxels));
}

} // namespace volmark
