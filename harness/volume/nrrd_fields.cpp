#include "volume/nrrd_fields.h"

#include "volmark/error.h"
#include "volmark/parameters.h"
#include "volume/header_text.h"

#include <fmt/format.h>

#include <algorithm>

namespace volmark {

namespace {

constexpr std::size_t kMaximumHeaderBytes = 64 * 1024;

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

bool isMagic(std::string_view line) {
  return line.size() == 8 && line.starts_with("NRRD000") && line[7] >= '1' && line[7] <= '5';
}

} // namespace

NrrdFields::NrrdFields(const std::filesystem::path& path) : m_file(path.string()) {
  const std::string text = readFileStart(path, kMaximumHeaderBytes);
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
