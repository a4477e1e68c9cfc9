#include "volume/nrrd.h"

#include "volmark/error.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <fstream>

namespace volmark {

namespace {

constexpr std::size_t kBlockBytes = 256 * 1024;
constexpr std::uint64_t kMaximumOutput = 1u << 30; // zlib counts in 32 bits

/// Gzip members of a file, one after the other, as one stream of decoded bytes.
class GzipReader {
public:
  GzipReader(const std::filesystem::path& path, std::uint64_t offset)
      : m_place(path.string()), m_file(path, std::ios::binary), m_block(kBlockBytes) {
    m_file.seekg(static_cast<std::streamoff>(offset));
    if (!m_file) throw InputError(fmt::format("{}: can't be opened", m_place));
    // 15: the largest window; 16: a gzip frame, with its checksum.
    if (inflateInit2(&m_stream, 15 + 16) != Z_OK) throw InputError(fmt::format("{}: no memory to decompress", m_place));
  }
  ~GzipReader() { inflateEnd(&m_stream); }
  GzipReader(const GzipReader&) = delete;
  GzipReader& operator=(const GzipReader&) = delete;

  /// Decodes to `output` and returns how many bytes it got: fewer than asked only at the stream's end.
  std::size_t read(std::span<std::byte> output) {
    std::size_t done = 0;
    while (done < output.size() && !m_ended) {
      const auto space = static_cast<uInt>(std::min<std::uint64_t>(output.size() - done, kMaximumOutput));
      m_stream.next_out = reinterpret_cast<Bytef*>(output.data() + done);
      m_stream.avail_out = space;
      advance();
      done += space - m_stream.avail_out;
    }
    return done;
  }

private:
  void advance() {
    if (m_stream.avail_in == 0) fill();
    const int result = inflate(&m_stream, Z_NO_FLUSH);
    if (result == Z_STREAM_END) return startNextMember();
    if (result == Z_BUF_ERROR && m_stream.avail_in == 0 && m_file.eof())
      throw InputError(fmt::format("{}: the gzip stream is cut off", m_place));
    if (result != Z_OK && result != Z_BUF_ERROR)
      throw InputError(
          fmt::format("{}: damaged gzip stream ({})", m_place, m_stream.msg ? m_stream.msg : zError(result)));
  }

  void fill() {
    m_file.read(reinterpret_cast<char*>(m_block.data()), static_cast<std::streamsize>(m_block.size()));
    m_stream.next_in = m_block.data();
    m_stream.avail_in = static_cast<uInt>(m_file.gcount());
  }

  void startNextMember() {
    if (m_stream.avail_in == 0) fill();
    m_ended = m_stream.avail_in == 0;
    if (!m_ended) inflateReset(&m_stream);
  }

  std::string m_place;
  std::ifstream m_file;
  std::vector<Bytef> m_block;
  z_stream m_stream{};
  bool m_ended = false;
};

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

  std::vector<std::byte> voxels = allocateVoxels(place, header.voxelBytes());
  const std::size_t found = reader.read(voxels);
  if (found < voxels.size())
    throw InputError(fmt::format("{}: the gzip stream holds {} bytes of voxels, expected {} as the header declares",
                                 place, found, voxels.size()));
  // One byte more also makes zlib check the length and checksum at the end of the stream.
  if (reader.read(std::span(scratch).first(1)) > 0)
    throw InputError(fmt::format("{}: the gzip stream holds more than the {} bytes of voxels that the header declares",
                                 place, voxels.size()));
  return voxels;
}

} // namespace

std::shared_ptr<const Volume> loadNrrd(const std::filesystem::path& path, std::uint64_t maximumBytes) {
  const NrrdHeader header = readNrrdHeader(path, maximumBytes);
  std::vector<std::byte> voxels =
      header.gzip ? inflateVoxels(header) : readVoxels(header.dataFile, header.dataOffset, header.voxelBytes());
  toNativeOrder(voxels, header.type, header.bigEndian);
  return std::make_shared<const Volume>(path.filename().string(), header.grid, header.type, std::move(voxels),
                                        header.timeSteps);
}

} // namespace volmark
