#include "volume/nrrd.h"

#include "volmark/error.h"
#include "volume/gzip_reader.h"
#include "volume/mapped_file.h"
#include "volume/orientation.h"
#include "volume/volume_cache.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace volmark {

namespace {

constexpr std::size_t kBlockBytes = 256 * 1024;

std::vector<std::byte> inflateVoxels(const NrrdHeader& header) {
  const std::string place = header.dataFile.string();
  GzipReader reader(header.dataFile, header.dataOffset);
  std::vector<std::byte> scratch(kBlockBytes);
  for (std::uint64_t left = header.skippedBytes; left > 0;) {
    const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(left, scratch.size()));
    if (reader.read(std::span(scratch).first(part)) < part)
      throw InputError(fmt::format("{}: the gzip stream ends within the {} bytes to skip", place, header.skippedBytes));
    left -= part;
  }

  // Memory grows with what is there, not with what the header declares.
  const std::uint64_t declared = header.voxelBytes();
  std::vector<std::byte> voxels = reserveVoxels(place, declared);
  while (voxels.size() < declared) {
    const std::size_t done = voxels.size();
    voxels.resize(static_cast<std::size_t>(std::min<std::uint64_t>(declared, done + kBlockBytes)));
    const std::size_t found = done + reader.read(std::span(voxels).subspan(done));
    if (found < voxels.size())
      throw InputError(fmt::format("{}: the gzip stream holds {} bytes of voxels, expected {} as the header declares",
                                   place, found, declared));
  }
  // One byte more also makes zlib check the length and checksum at the end of the stream.
  if (reader.read(std::span(scratch).first(1)) > 0)
    throw InputError(fmt::format("{}: the gzip stream holds more than the {} bytes of voxels that the header declares",
                                 place, voxels.size()));
  return voxels;
}

std::shared_ptr<const Volume> decode(const std::filesystem::path& path, const NrrdHeader& header) {
  std::vector<std::byte> voxels =
      header.gzip ? inflateVoxels(header) : readVoxels(header.dataFile, header.dataOffset, header.voxelBytes());
  toNativeOrder(voxels, header.type, header.bigEndian);
  std::vector<std::string> notes;
  Grid grid = header.grid;
  voxels = turnToPatientAxes(std::move(voxels), header.type, header.timeSteps, header.directions, grid, notes);
  return std::make_shared<const Volume>(path.filename().string(), grid, header.type, std::move(voxels),
                                        header.timeSteps, std::move(notes));
}

} // namespace

std::shared_ptr<const Volume> loadNrrd(const std::filesystem::path& path, std::uint64_t maximumBytes) {
  const NrrdHeader header = readNrrdHeader(path, maximumBytes);
  const bool usableAsIs = !header.gzip && isNativeOrder(header.type, header.bigEndian) &&
                          nearestOrientation(header.directions).asStored() &&
                          header.dataOffset % sizeOf(header.type) == 0;
  if (usableAsIs)
    return std::make_shared<const Volume>(path.filename().string(), header.grid, header.type,
                                          mapFile(header.dataFile, header.dataOffset), header.timeSteps);
  return cachedVolume({path, header.dataFile}, "nrrd", maximumBytes, [&] { return decode(path, header); });
}

} // namespace volmark
