#include "gpu/spirv_cache.h"

#include "volmark/gpu/driver_environment.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <atomic>
#include <fstream>
#include <unistd.h>

namespace volmark::gpu {

namespace {

struct Header {
  char magic[8] = {'V', 'O', 'L', 'M', 'S', 'P', 'V', '\n'};
  std::uint32_t version = 1;
  std::uint32_t wordCount = 0;
  std::uint64_t checksum = 0; ///< XXH3-64 of the words
};

Header headerOf(std::span<const std::uint32_t> words) {
  Header header;
  header.wordCount = static_cast<std::uint32_t>(words.size());
  header.checksum = XXH3_64bits(words.data(), words.size_bytes());
  return header;
}

bool equal(const Header& a, const Header& b) {
  return std::equal(std::begin(a.magic), std::end(a.magic), std::begin(b.magic)) && a.version == b.version &&
         a.wordCount == b.wordCount && a.checksum == b.checksum;
}

} // namespace

std::filesystem::path spirvCacheFile(const std::string& key) {
  return cacheFolder() / "spirv" / (key + ".spv");
}

std::optional<std::vector<std::uint32_t>> readSpirv(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  Header header;
  if (!stream.read(reinterpret_cast<char*>(&header), sizeof header)) return std::nullopt;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error || size != sizeof header + std::uintmax_t(header.wordCount) * sizeof(std::uint32_t)) return std::nullopt;
  std::vector<std::uint32_t> words(header.wordCount);
  if (!stream.read(reinterpret_cast<char*>(words.data()), static_cast<std::streamsize>(words.size() * sizeof words[0])))
    return std::nullopt;
  if (words.empty() || !equal(header, headerOf(words))) return std::nullopt;
  return words;
}

void writeSpirv(const std::filesystem::path& file, std::span<const std::uint32_t> words) noexcept {
  try {
    static std::atomic<int> counter{0};
    std::filesystem::create_directories(file.parent_path());
    const std::filesystem::path part = fmt::format("{}.{}.{}", file.string(), getpid(), counter++);
    const Header header = headerOf(words);
    std::ofstream stream(part, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(&header), sizeof header);
    stream.write(reinterpret_cast<const char*>(words.data()), static_cast<std::streamsize>(words.size_bytes()));
    stream.close();
    std::error_code ignored;
    if (stream) std::filesystem::rename(part, file, ignored);
    if (!stream || ignored) std::filesystem::remove(part, ignored);
  } catch (const std::exception&) {
    // Without a cache, the next start compiles again.
  }
}

} // namespace volmark::gpu
