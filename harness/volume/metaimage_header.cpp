// MetaImage headers: "key = value" lines up to ElementDataFile.
#include "volmark/error.h"
#include "volume/file_claims.h"
#include "volume/gzip_reader.h"
#include "volume/header_text.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

namespace volmark {

namespace {

constexpr std::size_t kMaximumHeaderBytes = 64 * 1024;

class Header {
public:
  explicit Header(const std::filesystem::path& path)
      : m_file(path.string()), m_text(readFileStart(path, kMaximumHeaderBytes)) {
    for (std::size_t begin = 0; begin < m_text.size();) {
      const std::size_t end = std::min(m_text.find('\n', begin), m_text.size());
      if (end == kMaximumHeaderBytes) break; // a line that was cut
      const std::string_view line = std::string_view(m_text).substr(begin, end - begin);
      begin = end + 1;
      const std::size_t equals = line.find('=');
      if (equals == std::string_view::npos)
        throw InputError(fmt::format("{}: not a MetaImage: header line {}, allowed: key = value", m_file, shown(line)));
      const std::string key(trimmed(line.substr(0, equals)));
      // The library takes a colon for an equals sign and would read another header than this one.
      if (key.find(':') != std::string::npos)
        throw InputError(
            fmt::format("{}: header line {}, allowed: key = value, without a colon in the key", m_file, shown(line)));
      if (!m_fields.emplace(key, trimmed(line.substr(equals + 1))).second) refuse(key, "twice", "once");
      if (key != "ElementDataFile") continue;
      m_bytes = begin;
      return;
    }
    throw InputError(
        fmt::format("{}: not a MetaImage: no ElementDataFile in the first {} bytes", m_file, kMaximumHeaderBytes));
  }

  const std::string& file() const { return m_file; }
  std::uint64_t bytes() const { return m_bytes; } ///< with the line of ElementDataFile

  std::string text(const std::string& key) const {
    const auto found = m_fields.find(key);
    if (found == m_fields.end()) throw InputError(fmt::format("{}: {} is missing", m_file, key));
    return found->second;
  }
  std::string text(const std::string& key, const std::string& otherwise) const {
    return m_fields.contains(key) ? text(key) : otherwise;
  }
  std::int64_t integer(const std::string& key, std::int64_t minimum, std::int64_t maximum) const {
    const auto value = parseInteger(text(key), minimum, maximum);
    if (!value) refuse(key, text(key), fmt::format("a whole number from {} to {}", minimum, maximum));
    return *value;
  }
  bool isTrue(const std::string& key) const {
    const std::string value = lowerCase(text(key, "false"));
    return value.starts_with('t') || value.starts_with('1');
  }
  [[noreturn]] void refuse(const std::string& key, std::string_view found, std::string_view allowed) const {
    throw InputError(fmt::format("{}: {}: found {}, allowed: {}", m_file, key, shown(found), allowed));
  }

private:
  std::string m_file;
  std::string m_text;
  std::uint64_t m_bytes = 0;
  std::map<std::string, std::string> m_fields;
};

std::size_t scalarBytesOf(const Header& header) {
  static const std::map<std::string, std::size_t> sizes = {{"MET_CHAR", 1},   {"MET_UCHAR", 1}, {"MET_SHORT", 2},
                                                           {"MET_USHORT", 2}, {"MET_INT", 4},   {"MET_UINT", 4},
                                                           {"MET_FLOAT", 4},  {"MET_DOUBLE", 8}};
  const auto found = sizes.find(header.text("ElementType"));
  if (found == sizes.end())
    header.refuse("ElementType", header.text("ElementType"),
                  "MET_CHAR, MET_UCHAR, MET_SHORT, MET_USHORT, MET_INT, MET_UINT, MET_FLOAT, MET_DOUBLE");
  return found->second;
}

void readSizes(const Header& header, FileClaim& claim) {
  const auto dimensions = static_cast<std::size_t>(header.integer("NDims", 3, 4));
  const std::vector<std::string> words = splitWords(header.text("DimSize"));
  if (words.size() != dimensions)
    header.refuse("DimSize", header.text("DimSize"), fmt::format("{} numbers, as NDims says", dimensions));
  for (std::size_t axis = 0; axis < dimensions; ++axis) {
    const auto size = parseInteger(words[axis], 1, std::numeric_limits<int>::max());
    if (!size) header.refuse("DimSize", words[axis], "whole numbers from 1");
    (axis < 3 ? claim.dims[static_cast<int>(axis)] : claim.timeSteps) = static_cast<int>(*size);
  }
}

bool isLocal(const Header& header) {
  return lowerCase(header.text("ElementDataFile")) == "local";
}

/// Where the voxels are: the header's own file if they are local.
std::filesystem::path dataFileOf(const Header& header, const std::filesystem::path& path) {
  const std::string named = header.text("ElementDataFile");
  if (isLocal(header)) return path;
  if (named.starts_with("LIST") || named.find('%') != std::string::npos)
    header.refuse("ElementDataFile", named, "LOCAL or one file name; lists and patterns of files are not read");
  return path.parent_path() / named;
}

} // namespace

std::filesystem::path metaImageDataFile(const std::filesystem::path& path) {
  return dataFileOf(Header(path), path);
}

FileClaim checkMetaImage(const std::filesystem::path& path, std::uint64_t maximumBytes) {
  const Header header(path);
  FileClaim claim;
  readSizes(header, claim);
  claim.scalarBytes = scalarBytesOf(header);
  if (header.text("ElementNumberOfChannels", "1") != "1")
    header.refuse("ElementNumberOfChannels", header.text("ElementNumberOfChannels"), "1");
  if (!header.isTrue("BinaryData")) header.refuse("BinaryData", header.text("BinaryData", "False"), "True");
  checkClaimedSize(header.file(), claim, maximumBytes);

  const std::filesystem::path file = dataFileOf(header, path);
  const std::uint64_t length = fileLength(file);
  std::uint64_t offset = isLocal(header) ? header.bytes() : 0;
  const std::int64_t skip = header.text("HeaderSize", "0") == "0" || header.text("HeaderSize").empty()
                                ? 0
                                : header.integer("HeaderSize", -1, std::numeric_limits<std::int64_t>::max());
  if (skip < 0)
    offset = length - std::min(length, claim.bytes()); // the voxels are the end of the file
  else if (skip > 0)
    offset = static_cast<std::uint64_t>(skip); // from the start of the file, also of the header's own
  const std::uint64_t available = length - std::min(length, offset);
  if (!header.isTrue("CompressedData")) {
    if (available != claim.bytes())
      throw InputError(fmt::format("{}: found {} bytes of voxels, expected {} as the header declares", file.string(),
                                   available, claim.bytes()));
    return claim;
  }
  std::uint64_t encoded = available;
  if (!header.text("CompressedDataSize", "").empty()) {
    const auto size = header.integer("CompressedDataSize", 1, std::numeric_limits<std::int64_t>::max());
    if (static_cast<std::uint64_t>(size) > available)
      header.refuse("CompressedDataSize", header.text("CompressedDataSize"),
                    fmt::format("at most the {} bytes that the file has", available));
    encoded = static_cast<std::uint64_t>(size);
  }
  checkDecodedLength(file, offset, encoded, claim.bytes());
  return claim;
}

} // namespace volmark
