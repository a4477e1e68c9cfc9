// Legacy VTK headers: two lines, a format, then keywords up to the voxels.
#include "volmark/error.h"
#include "volume/file_claims.h"
#include "volume/header_text.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

namespace volmark {

namespace {

constexpr std::size_t kMaximumHeaderBytes = 64 * 1024;

/// The header's lines in order.
class Header {
public:
  explicit Header(const std::filesystem::path& path)
      : m_file(path.string()), m_text(readFileStart(path, kMaximumHeaderBytes)) {}

  const std::string& file() const { return m_file; }
  std::uint64_t position() const { return m_position; }

  /// Words of the next line that has any.
  std::vector<std::string> words() {
    std::vector<std::string> result;
    while (result.empty())
      result = splitWords(line());
    return result;
  }
  std::string_view line() {
    const std::size_t end = m_text.find('\n', m_position);
    if (end == std::string::npos) fail("the header has no end");
    const std::string_view result = std::string_view(m_text).substr(m_position, end - m_position);
    m_position = end + 1;
    return result;
  }
  [[noreturn]] void fail(const std::string& what) const { throw InputError(fmt::format("{}: {}", m_file, what)); }
  [[noreturn]] void refuse(std::string_view key, std::string_view found, std::string_view allowed) const {
    fail(fmt::format("{}: found {}, allowed: {}", key, shown(found), allowed));
  }

private:
  std::string m_file;
  std::string m_text;
  std::size_t m_position = 0;
};

std::size_t scalarBytesOf(const Header& header, const std::string& type) {
  static const std::map<std::string, std::size_t> sizes = {
      {"char", 1}, {"unsigned_char", 1}, {"short", 2}, {"unsigned_short", 2},
      {"int", 4},  {"unsigned_int", 4},  {"float", 4}, {"double", 8}};
  const auto found = sizes.find(type);
  if (found == sizes.end())
    header.refuse("SCALARS", type, "char, unsigned_char, short, unsigned_short, int, unsigned_int, float, double");
  return found->second;
}

void readDimensions(const Header& header, const std::vector<std::string>& words, FileClaim& claim) {
  if (words.size() != 4) header.fail("DIMENSIONS: allowed: three numbers");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto size = parseInteger(words[axis + 1], 1, std::numeric_limits<int>::max());
    if (!size) header.refuse("DIMENSIONS", words[axis + 1], "whole numbers from 1");
    claim.dims[static_cast<int>(axis)] = static_cast<int>(*size);
  }
}

} // namespace

FileClaim checkVtk(const std::filesystem::path& path, std::uint64_t maximumBytes) {
  Header header(path);
  const std::string_view first = header.line();
  if (!first.starts_with("# vtk DataFile Version"))
    header.fail(fmt::format("not a legacy VTK file: starts with {}", shown(first)));
  header.line(); // title
  const std::string format = header.words().front();
  if (format != "BINARY") header.refuse("format", format, "BINARY");
  FileClaim claim;
  bool sized = false;
  for (;;) {
    const std::vector<std::string> words = header.words();
    const std::string key = lowerCase(words.front());
    if (key == "dataset" && (words.size() != 2 || lowerCase(words[1]) != "structured_points"))
      header.refuse("DATASET", words.back(), "STRUCTURED_POINTS");
    if (key == "dimensions") {
      readDimensions(header, words, claim);
      sized = true;
    }
    if (key == "vectors" || key == "tensors" || key == "color_scalars" || key == "field" || key == "cell_data")
      header.refuse("data", words.front(), "SCALARS");
    if (key != "scalars") continue;
    if (!sized) header.fail("DIMENSIONS is missing before SCALARS");
    if (words.size() < 3 || words.size() > 4 || (words.size() == 4 && words[3] != "1"))
      header.refuse("SCALARS", words.back(), "name, type and one component");
    claim.scalarBytes = scalarBytesOf(header, lowerCase(words[2]));
    break;
  }
  if (const auto words = header.words(); lowerCase(words.front()) != "lookup_table")
    header.refuse("after SCALARS", words.front(), "LOOKUP_TABLE");
  checkClaimedSize(header.file(), claim, maximumBytes);
  const std::uint64_t available = fileLength(path) - header.position();
  // Writers end the voxels with a line break or not, and may go on with other attributes.
  if (available < claim.bytes())
    header.fail(fmt::format("found {} bytes of voxels, expected {} as the header declares", available, claim.bytes()));
  return claim;
}

} // namespace volmark
