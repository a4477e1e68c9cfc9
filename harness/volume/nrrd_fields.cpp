#include "volume/nrrd_fields.h"

#include "volmark/error.h"
#include "volmark/parameters.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <sstream>

namespace volmark {

namespace {

constexpr std::size_t kMaximumHeaderBytes = 64 * 1024;
constexpr std::size_t kMaximumQuoted = 60;

/// All fields of NRRD0005; those with two spellings are here in the one with a space.
const std::vector<std::string> kLegalFields = {"axis maxs",
                                               "axis mins",
                                               "block size",
                                               "byte skip",
                                               "centers",
                                               "content",
                                               "data file",
                                               "dimension",
                                               "encoding",
                                               "endian",
                                               "kinds",
                                               "labels",
                                               "line skip",
                                               "max",
                                               "measurement frame",
                                               "min",
                                               "number",
                                               "old max",
                                               "old min",
                                               "sample units",
                                               "sizes",
                                               "space",
                                               "space dimension",
                                               "space directions",
                                               "space origin",
                                               "space units",
                                               "spacings",
                                               "thicknesses",
                                               "type",
                                               "units"};

/// Fields may also be written without the space, and "centers" as "centerings".
std::string canonicalName(const std::string& name) {
  if (name == "centerings") return "centers";
  for (const std::string& legal : kLegalFields) {
    std::string joined = legal;
    std::erase(joined, ' ');
    if (joined == name) return legal;
  }
  return name;
}

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

/// Text of a file as it may stand in a one-line message.
std::string shown(std::string_view text) {
  std::string result(text.substr(0, kMaximumQuoted));
  for (char& c : result)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return fmt::format("\"{}{}\"", result, text.size() > kMaximumQuoted ? "..." : "");
}

bool isMagic(std::string_view line) {
  return line.size() == 8 && line.starts_with("NRRD000") && line[7] >= '1' && line[7] <= '5';
}

std::string readStart(const std::filesystem::path& path) {
  const std::uint64_t length = fileLength(path);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: can't be opened", path.string()));
  std::string text(static_cast<std::size_t>(std::min<std::uint64_t>(length, kMaximumHeaderBytes)), '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file) throw InputError(fmt::format("{}: can't be read", path.string()));
  return text;
}

} // namespace

std::string lowerCase(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

std::optional<std::int64_t> parseInteger(std::string_view text, std::int64_t minimum, std::int64_t maximum) {
  std::int64_t value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size()) return std::nullopt;
  if (value < minimum || value > maximum) return std::nullopt;
  return value;
}

std::optional<double> parseNumber(std::string_view text) {
  double value = 0;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

std::vector<std::string> splitWords(std::string_view text) {
  std::istringstream stream{std::string(text)};
  std::vector<std::string> words;
  for (std::string word; stream >> word;)
    words.push_back(word);
  return words;
}

NrrdFields::NrrdFields(const std::filesystem::path& path) : m_file(path.string()) {
  const std::string text = readStart(path);
  for (std::size_t begin = 0, number = 1; begin < text.size(); ++number) {
    const std::size_t end = text.find('\n', begin);
    if (end == std::string::npos && text.size() == kMaximumHeaderBytes) break;
    std::string_view line = std::string_view(text).substr(begin, std::min(end, text.size()) - begin);
    if (line.ends_with('\r')) line.remove_suffix(1);
    begin = end == std::string::npos ? text.size() : end + 1;
    m_headerBytes = begin;

    if (number == 1) {
      if (isMagic(line)) continue;
      throw InputError(
          fmt::format("{}: not an NRRD file: starts with {}, allowed: NRRD0001 to NRRD0005", m_file, shown(line)));
    }
    m_endsWithBlankLine = line.empty();
    if (m_endsWithBlankLine) return;
    add(line);
  }
  if (text.empty()) throw InputError(fmt::format("{}: not an NRRD file: it is empty", m_file));
  if (text.size() == kMaximumHeaderBytes)
    throw InputError(fmt::format("{}: the header has no end in its first {} bytes", m_file, kMaximumHeaderBytes));
}

void NrrdFields::add(std::string_view line) {
  if (line.starts_with('#')) return;
  const std::size_t colon = line.find(':');
  const std::string written = lowerCase(trimmed(line.substr(0, std::min(colon, line.size()))));
  const std::string name = canonicalName(written);
  const bool isField = std::find(kLegalFields.begin(), kLegalFields.end(), name) != kLegalFields.end();
  const bool isPair = line.find(":=") != std::string_view::npos;
  if (isPair && (!isField || line.substr(colon).starts_with(":="))) return;
  if (colon == std::string_view::npos)
    throw InputError(fmt::format("{}: header line {}: allowed: \"field: description\", \"key:=value\", \"# comment\"",
                                 m_file, shown(line)));
  if (!isField) {
    const auto nearest = nearestName(name, kLegalFields);
    throw InputError(fmt::format("{}: unknown field {}{}", m_file, shown(written),
                                 nearest ? fmt::format(", did you mean \"{}\"?", *nearest) : ""));
  }
  if (!m_fields.emplace(name, trimmed(line.substr(colon + 1))).second)
    throw InputError(fmt::format("{}: field \"{}\" stands there twice", m_file, name));
}

std::optional<std::string> NrrdFields::find(const std::string& name) const {
  const auto found = m_fields.find(name);
  return found == m_fields.end() ? std::nullopt : std::optional(found->second);
}

std::string NrrdFields::at(const std::string& name) const {
  const auto found = find(name);
  if (!found) throw InputError(fmt::format("{}: field \"{}\" is missing", m_file, name));
  return *found;
}

std::vector<std::string> NrrdFields::words(const std::string& name, std::size_t count) const {
  const std::string text = at(name);
  std::vector<std::string> result = splitWords(text);
  if (result.size() != count) refuse(name, text, fmt::format("{} values, one per axis", count));
  return result;
}

void NrrdFields::refuse(const std::string& name, std::string_view found, std::string_view allowed) const {
  throw InputError(fmt::format("{}: field \"{}\": found {}, allowed: {}", m_file, name, shown(found), allowed));
}

} // namespace volmark
