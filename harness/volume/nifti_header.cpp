// NIfTI-1 headers: 348 bytes, in the byte order of the machine that wrote them, then extensions, then voxels.
#include "volmark/error.h"
#include "volume/file_claims.h"
#include "volume/gzip_reader.h"
#include "volume/header_text.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace volmark {

namespace {

constexpr std::size_t kHeaderBytes = 348;
constexpr std::size_t kFirstVoxel = 352;
constexpr std::uint64_t kMaximumVoxelOffset = 64u << 20; // extensions hold texts and small tables

/// Places of the fields that matter (nifti1.h).
enum Place : std::size_t { dimensions = 40, datatype = 70, bitsPerVoxel = 72, voxelOffset = 108, magic = 344 };

class Header {
public:
  Header(std::string file, std::array<std::byte, kFirstVoxel> bytes) : m_file(std::move(file)), m_bytes(bytes) {
    if (std::memcmp(m_bytes.data() + magic, "n+1", 4) != 0)
      throw InputError(fmt::format("{}: not NIfTI-1 in one file: found {} where \"n+1\" must be (NIfTI-2, Analyze and "
                                   ".hdr/.img pairs are not read)",
                                   m_file, shown({reinterpret_cast<const char*>(m_bytes.data()) + magic, 3})));
    if (number<std::int32_t>(0) == std::int32_t(kHeaderBytes)) return;
    m_swapped = true;
    if (number<std::int32_t>(0) != std::int32_t(kHeaderBytes))
      throw InputError(
          fmt::format("{}: not NIfTI-1: the header's size is not {} in either byte order", m_file, kHeaderBytes));
  }

  const std::string& file() const { return m_file; }

  template <class T> T number(std::size_t place) const {
    std::array<std::byte, sizeof(T)> bytes;
    std::memcpy(bytes.data(), m_bytes.data() + place, sizeof(T));
    if (m_swapped) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
  }
  int size(int axis) const { return number<std::int16_t>(dimensions + 2 * static_cast<std::size_t>(axis)); }

  template <class Found>
  [[noreturn]] void refuse(std::string_view field, const Found& found, std::string_view allowed) const {
    throw InputError(fmt::format("{}: {}: found {}, allowed: {}", m_file, field, found, allowed));
  }

private:
  std::string m_file;
  std::array<std::byte, kFirstVoxel> m_bytes;
  bool m_swapped = false;
};

std::size_t scalarBytesOf(const Header& header) {
  const int type = header.number<std::int16_t>(datatype);
  std::size_t bytes = 0;
  switch (type) {
  case 2:
  case 256: bytes = 1; break; // uint8, int8
  case 4:
  case 512: bytes = 2; break; // int16, uint16
  case 8:
  case 768:
  case 16: bytes = 4; break; // int32, uint32, float32
  case 64: bytes = 8; break; // float64
  default:
    header.refuse("datatype", type, "2, 256, 4, 512, 8, 768, 16, 64 (8-, 16- and 32-bit integers, float32, float64)");
  }
  if (header.number<std::int16_t>(bitsPerVoxel) != std::int16_t(8 * bytes))
    header.refuse("bitpix", header.number<std::int16_t>(bitsPerVoxel), fmt::format("{}, as datatype says", 8 * bytes));
  return bytes;
}

FileClaim claimOf(const Header& header) {
  FileClaim claim;
  const int count = header.size(0);
  if (count < 1 || count > 7) header.refuse("dim[0]", count, "3, or 4 with time");
  for (int axis = 1; axis <= count; ++axis) {
    const int size = header.size(axis);
    if (size < 1 || (axis > 4 && size != 1))
      header.refuse(fmt::format("dim[{}]", axis), size, axis > 4 ? "1" : "at least 1");
    if (axis < 4) claim.dims[axis - 1] = size;
    if (axis == 4) claim.timeSteps = size;
  }
  claim.scalarBytes = scalarBytesOf(header);
  return claim;
}

std::uint64_t firstVoxelOf(const Header& header) {
  const float offset = header.number<float>(voxelOffset);
  if (!(offset >= float(kFirstVoxel) && offset <= float(kMaximumVoxelOffset)) || offset != std::floor(offset))
    header.refuse("vox_offset", offset, fmt::format("whole numbers from {} to {}", kFirstVoxel, kMaximumVoxelOffset));
  return static_cast<std::uint64_t>(offset);
}

bool isGzip(const std::filesystem::path& path) {
  const std::string start = readFileStart(path, 2);
  return start == "\x1f\x8b";
}

} // namespace

FileClaim checkNifti(const std::filesystem::path& path, std::uint64_t maximumBytes) {
  const std::string place = path.string();
  const bool gzip = isGzip(path);
  // The library goes by the name.
  if (gzip != (path.extension() == ".gz"))
    throw InputError(fmt::format("{}: found {} data, allowed: .nii.gz for gzip, .nii otherwise", place,
                                 gzip ? "gzip" : "uncompressed"));
  std::array<std::byte, kFirstVoxel> bytes{};
  std::size_t found = 0;
  if (gzip) {
    found = GzipReader(path, 0).read(bytes);
  } else {
    const std::string start = readFileStart(path, bytes.size());
    std::memcpy(bytes.data(), start.data(), found = start.size());
  }
  if (found < bytes.size())
    throw InputError(fmt::format("{}: not NIfTI-1: {} bytes, expected at least {}", place, found, bytes.size()));
  const Header header(place, bytes);
  const FileClaim claim = claimOf(header);
  checkClaimedSize(place, claim, maximumBytes);
  const std::uint64_t expected = firstVoxelOf(header) + claim.bytes();
  const std::uint64_t length = fileLength(path);
  if (gzip) {
    if (expected > length * kMaximumDeflateRatio)
      throw InputError(fmt::format("{}: the header declares {} bytes, more than {} bytes of gzip can hold", place,
                                   expected, length));
    checkDecodedLength(path, 0, length, expected);
  } else if (length != expected) {
    throw InputError(fmt::format("{}: found {} bytes, expected {} as the header declares", place, length, expected));
  }
  return claim;
}

} // namespace volmark
