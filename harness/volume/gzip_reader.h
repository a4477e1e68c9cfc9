// Deflate-compressed bytes of a file, decoded piece by piece.
#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace volmark {

/// The most that one compressed byte can stand for: deflate's best is 258 bytes from 2 bits.
constexpr std::uint64_t kMaximumDeflateRatio = 1032;

/// Gzip members (or one zlib stream) of a file, one after the other, as one stream of decoded bytes.
class GzipReader {
public:
  /// Reads at most `encodedBytes` from `offset`. Throws InputError.
  GzipReader(const std::filesystem::path& path, std::uint64_t offset,
             std::uint64_t encodedBytes = std::numeric_limits<std::uint64_t>::max());
  ~GzipReader();
  GzipReader(const GzipReader&) = delete;
  GzipReader& operator=(const GzipReader&) = delete;

  /// Decodes to `output` and returns how many bytes it got: fewer than asked only at the stream's end, whose
  /// checksum was right then. Throws InputError on a damaged or cut-off stream.
  std::size_t read(std::span<std::byte> output);

private:
  void advance();
  void fill();
  void startNextMember();

  std::string m_place;
  std::ifstream m_file;
  std::uint64_t m_left; ///< encoded bytes that may still be read
  std::vector<Bytef> m_block;
  z_stream m_stream{};
  bool m_ended = false;
};

/// Decodes and drops everything from `offset` and throws InputError unless it is exactly `decodedBytes` long: for
/// libraries that would not notice. Takes no memory.
void checkDecodedLength(const std::filesystem::path& path, std::uint64_t offset, std::uint64_t encodedBytes,
                        std::uint64_t decodedBytes);

} // namespace volmark
