#include "volume/gzip_reader.h"

#include "volmark/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace volmark {

namespace {

constexpr std::size_t kBlockBytes = 256 * 1024;
constexpr std::uint64_t kMaximumOutput = 1u << 30; // zlib counts in 32 bits

} // namespace

GzipReader::GzipReader(const std::filesystem::path& path, std::uint64_t offset, std::uint64_t encodedBytes)
    : m_place(path.string()), m_file(path, std::ios::binary), m_left(encodedBytes), m_block(kBlockBytes) {
  m_file.seekg(static_cast<std::streamoff>(offset));
  if (!m_file) throw InputError(fmt::format("{}: can't be opened", m_place));
  // 15: the largest window; 32: a gzip or zlib frame, with its checksum.
  if (inflateInit2(&m_stream, 15 + 32) != Z_OK) throw InputError(fmt::format("{}: no memory to decompress", m_place));
}

GzipReader::~GzipReader() {
  inflateEnd(&m_stream);
}

std::size_t GzipReader::read(std::span<std::byte> output) {
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

void GzipReader::advance() {
  if (m_stream.avail_in == 0) fill();
  const int result = inflate(&m_stream, Z_NO_FLUSH);
  if (result == Z_STREAM_END) return startNextMember();
  // Also where the file can't be read on.
  if (result == Z_BUF_ERROR && m_stream.avail_in == 0 && (!m_file || m_left == 0))
    throw InputError(fmt::format("{}: the gzip stream is cut off", m_place));
  if (result != Z_OK && result != Z_BUF_ERROR)
    throw InputError(
        fmt::format("{}: damaged gzip stream ({})", m_place, m_stream.msg ? m_stream.msg : zError(result)));
}

void GzipReader::fill() {
  const auto count = std::min<std::uint64_t>(m_left, m_block.size());
  m_file.read(reinterpret_cast<char*>(m_block.data()), static_cast<std::streamsize>(count));
  m_stream.next_in = m_block.data();
  m_stream.avail_in = static_cast<uInt>(m_file.gcount());
  m_left -= m_stream.avail_in;
}

void GzipReader::startNextMember() {
  if (m_stream.avail_in == 0) fill();
  m_ended = m_stream.avail_in == 0;
  if (!m_ended) inflateReset(&m_stream);
}

void checkDecodedLength(const std::filesystem::path& path, std::uint64_t offset, std::uint64_t encodedBytes,
                        std::uint64_t decodedBytes) {
  GzipReader reader(path, offset, encodedBytes);
  std::vector<std::byte> scratch(kBlockBytes);
  std::uint64_t found = 0;
  while (const std::size_t part = reader.read(scratch)) {
    found += part;
    if (found > decodedBytes) break;
  }
  if (found != decodedBytes)
    throw InputError(fmt::format("{}: the compressed voxels are {} bytes{}, expected {} as the header declares",
                                 path.string(), found, found > decodedBytes ? " or more" : "", decodedBytes));
}

} // namespace volmark
