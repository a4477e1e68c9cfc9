#include "volmark/error.h"
#include "volume/header_text.h"
#include "volume/mesh/mesh.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <unordered_map>

namespace volmark {

namespace {

constexpr std::uint64_t kLeastBytesPerItem = 4; // "0 0\n": what a point or a face takes at least
constexpr std::int64_t kMostCorners = 1000;
constexpr std::size_t kBlockBytes = 256 * 1024;
constexpr std::size_t kLongestWord = 100;
constexpr std::size_t kLongestLine = 64 * 1024;

/// The file's words, comments left out. Read piece by piece: a file may be longer than memory.
class Words {
public:
  explicit Words(const std::filesystem::path& path)
      : m_place(path.string()), m_bytes(fileLength(path)), m_file(path, std::ios::binary) {
    if (!m_file) throw InputError(fmt::format("{}: can't be opened", m_place));
  }

  /// Valid until the next one is read.
  const std::string& next(const char* what) {
    skipSpace();
    m_word.clear();
    for (; !ended() && !isSpace(here()); ++m_at) {
      m_word += here();
      if (m_word.size() > kLongestWord) refuse(what, m_word, fmt::format("at most {} characters", kLongestWord));
    }
    if (m_word.empty()) throw InputError(fmt::format("{}: the file ends before {}", m_place, what));
    return m_word;
  }
  std::int64_t integer(const char* what, std::int64_t minimum, std::int64_t maximum) {
    const std::string& word = next(what);
    const auto value = parseInteger(word, minimum, maximum);
    if (!value) refuse(what, word, fmt::format("a whole number from {} to {}", minimum, maximum));
    return *value;
  }
  float number(const char* what) {
    const std::string& word = next(what);
    const auto value = parseNumber(word);
    if (!value || !(std::abs(*value) < 1e9)) refuse(what, word, "a number within 1e9");
    return static_cast<float>(*value);
  }
  /// Colours may follow on the same line.
  void skipLine() {
    for (std::size_t skipped = 0; !ended() && here() != '\n'; ++m_at)
      if (++skipped > kLongestLine)
        throw InputError(fmt::format("{}: a line of more than {} characters", m_place, kLongestLine));
  }
  std::uint64_t bytes() const { return m_bytes; }
  [[noreturn]] void refuse(std::string_view what, std::string_view found, std::string_view allowed) const {
    throw InputError(fmt::format("{}: {}: found {}, allowed: {}", m_place, what, shown(found), allowed));
  }

private:
  static bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
  char here() const { return m_block[m_at]; }
  /// Whether there is no character left; otherwise the next one is in the block.
  bool ended() {
    if (m_at < m_filled) return false;
    m_file.read(m_block.data(), static_cast<std::streamsize>(m_block.size()));
    m_filled = static_cast<std::size_t>(m_file.gcount());
    m_at = 0;
    return m_filled == 0;
  }
  void skipSpace() {
    for (; !ended(); ++m_at) {
      if (here() == '#') skipLine();
      if (ended() || !isSpace(here())) return;
    }
  }

  std::string m_place;
  std::uint64_t m_bytes;
  std::ifstream m_file;
  std::vector<char> m_block = std::vector<char>(kBlockBytes);
  std::size_t m_filled = 0;
  std::size_t m_at = 0;
  std::string m_word;
};

} // namespace

Mesh readOff(const std::filesystem::path& path, std::uint64_t maximumBytes) {
  if (fileLength(path) > 8 * maximumBytes)
    throw InputError(
        fmt::format("{}: found {} bytes of text, allowed: {}", path.string(), fileLength(path), 8 * maximumBytes));
  Words words(path);
  const std::string& magic = words.next("\"OFF\"");
  if (magic != "OFF" && magic != "COFF") words.refuse("not an OFF file: its start", magic, "OFF, COFF");
  // No more of anything than the text has room for.
  const auto most =
      static_cast<std::int64_t>(std::min(words.bytes() / kLeastBytesPerItem, maximumBytes / sizeof(glm::vec3)));
  const std::int64_t points = words.integer("number of points", 1, most);
  const std::int64_t faces = words.integer("number of faces", 1, most);
  words.integer("number of edges", 0, std::int64_t(1) << 40);

  Mesh mesh;
  mesh.points.reserve(static_cast<std::size_t>(points));
  for (std::int64_t i = 0; i < points; ++i) {
    glm::vec3 point;
    for (int axis = 0; axis < 3; ++axis)
      point[axis] = words.number("coordinate");
    mesh.points.push_back(point);
    words.skipLine();
  }
  for (std::int64_t i = 0; i < faces; ++i) {
    const std::int64_t corners = words.integer("corners of a face", 3, kMostCorners);
    const auto corner = [&] { return static_cast<std::uint32_t>(words.integer("corner", 0, points - 1)); };
    const std::uint32_t first = corner();
    std::uint32_t before = corner();
    for (std::int64_t j = 2; j < corners; ++j) {
      const std::uint32_t here = corner();
      mesh.triangles.emplace_back(first, before, here);
      before = here;
    }
    words.skipLine();
  }
  return mesh;
}

void requireClosed(const std::filesystem::path& path, const Mesh& mesh) {
  // Directed edges, by how many triangles run along them.
  std::unordered_map<std::uint64_t, int> edges;
  edges.reserve(mesh.triangles.size() * 3);
  const auto key = [](std::uint32_t from, std::uint32_t to) { return std::uint64_t(from) << 32 | to; };
  for (const glm::uvec3& triangle : mesh.triangles)
    for (int i = 0; i < 3; ++i)
      ++edges[key(triangle[i], triangle[(i + 1) % 3])];
  std::size_t open = 0;
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find(edge << 32 | edge >> 32);
    if (count != 1 || back == edges.end() || back->second != 1) ++open;
  }
  if (open > 0)
    throw InputError(fmt::format("{}: {} edges have no triangle, or more than one, on a side, allowed: a closed mesh "
                                 "whose triangles turn the same way",
                                 path.string(), open));
}

} // namespace volmark
