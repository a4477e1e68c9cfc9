// Meaning and checks of NRRD header fields.
#include "volmark/error.h"
#include "volume/gzip_reader.h"
#include "volume/header_text.h"
#include "volume/nrrd.h"
#include "volume/nrrd_fields.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>

namespace volmark {

namespace {

constexpr std::int64_t kMaximumSize = std::numeric_limits<int>::max();
constexpr double kMaximumSpacing = 1e9;
constexpr std::size_t kMaximumSkippedText = 1 << 20;

struct TypeSpelling {
  std::string_view name;
  ScalarType type;
};
constexpr std::array<TypeSpelling, 18> kTypeSpellings = {{
    {"signed char", ScalarType::int8},
    {"int8", ScalarType::int8},
    {"int8_t", ScalarType::int8},
    {"uchar", ScalarType::uint8},
    {"unsigned char", ScalarType::uint8},
    {"uint8", ScalarType::uint8},
    {"uint8_t", ScalarType::uint8},
    {"short", ScalarType::int16},
    {"short int", ScalarType::int16},
    {"signed short", ScalarType::int16},
    {"signed short int", ScalarType::int16},
    {"int16", ScalarType::int16},
    {"int16_t", ScalarType::int16},
    {"ushort", ScalarType::uint16},
    {"unsigned short", ScalarType::uint16},
    {"unsigned short int", ScalarType::uint16},
    {"uint16", ScalarType::uint16},
    {"uint16_t", ScalarType::uint16},
}};

ScalarType typeOf(const NrrdFields& fields) {
  // White space inside a name counts as one space.
  const std::string name = fmt::format("{}", fmt::join(splitWords(lowerCase(fields.at("type"))), " "));
  if (name == "float") return ScalarType::float32;
  for (const TypeSpelling& spelling : kTypeSpellings)
    if (spelling.name == name) return spelling.type;
  fields.refuse("type", fields.at("type"), "int8, uint8, int16, uint16, float");
}

bool isGzip(const NrrdFields& fields) {
  const std::string encoding = lowerCase(fields.at("encoding"));
  if (encoding == "raw") return false;
  if (encoding == "gzip" || encoding == "gz") return true;
  fields.refuse("encoding", fields.at("encoding"), "raw, gzip");
}

bool isBigEndian(const NrrdFields& fields, ScalarType type) {
  if (sizeOf(type) == 1) return false;
  const std::string endian = lowerCase(fields.at("endian"));
  if (endian == "little") return false;
  if (endian == "big") return true;
  fields.refuse("endian", fields.at("endian"), "little, big");
}

/// 3 or 4.
std::size_t dimensionOf(const NrrdFields& fields) {
  const std::string text = fields.at("dimension");
  const auto dimension = parseInteger(text, 3, 4);
  if (!dimension) fields.refuse("dimension", text, "3, or 4 with time as the last axis");
  return static_cast<std::size_t>(*dimension);
}

void readSizes(const NrrdFields& fields, std::size_t dimension, NrrdHeader& header) {
  const std::vector<std::string> words = fields.words("sizes", dimension);
  for (std::size_t axis = 0; axis < dimension; ++axis) {
    const auto size = parseInteger(words[axis], 1, kMaximumSize);
    if (!size) fields.refuse("sizes", words[axis], fmt::format("whole numbers from 1 to {}", kMaximumSize));
    if (axis < 3)
      header.grid.dims[static_cast<int>(axis)] = static_cast<int>(*size);
    else
      header.timeSteps = static_cast<int>(*size);
  }
}

/// Colours and vectors would pass for depth or time.
void refuseOtherKinds(const NrrdFields& fields, std::size_t dimension) {
  if (!fields.find("kinds")) return;
  const std::vector<std::string> kinds = fields.words("kinds", dimension);
  for (std::size_t axis = 0; axis < dimension; ++axis) {
    const std::string kind = lowerCase(kinds[axis]);
    const bool spatial = kind == "domain" || kind == "space" || kind == "none" || kind == "???";
    if (spatial || (axis == 3 && (kind == "time" || kind == "list"))) continue;
    fields.refuse("kinds", kinds[axis],
                  axis < 3 ? "domain or space for the first three axes" : "time, list or domain for the last axis");
  }
}

double checkedSpacing(const NrrdFields& fields, const std::string& name, const std::string& text, double spacing) {
  if (std::isnan(spacing)) return 1;
  if (!(spacing >= 1 / kMaximumSpacing && spacing <= kMaximumSpacing))
    fields.refuse(name, text, fmt::format("lengths from {:g} to {:g}", 1 / kMaximumSpacing, kMaximumSpacing));
  return spacing;
}

/// "(1,0,0) (0, 1, 0) none": the vectors between brackets, or the word "none".
std::vector<std::string> splitDirections(const NrrdFields& fields, const std::string& text) {
  std::vector<std::string> result;
  for (std::size_t at = text.find_first_not_of(" \t"); at != std::string::npos;
       at = text.find_first_not_of(" \t", at)) {
    const bool isVector = text[at] == '(';
    const std::size_t end = isVector ? text.find(')', at) : text.find_first_of(" \t(", at);
    if (isVector && end == std::string::npos) fields.refuse("space directions", text, "\")\" after every \"(\"");
    if (isVector) ++at;
    result.push_back(text.substr(at, end == std::string::npos ? end : end - at));
    at = end == std::string::npos ? text.size() : end + (isVector ? 1 : 0);
  }
  return result;
}

glm::dvec3 vectorOf(const NrrdFields& fields, std::string direction) {
  std::replace(direction.begin(), direction.end(), ',', ' ');
  const std::vector<std::string> words = splitWords(direction);
  if (words.size() != 3) fields.refuse("space directions", direction, "vectors of 3 numbers");
  glm::dvec3 vector;
  for (int i = 0; i < 3; ++i) {
    const auto component = parseNumber(words[static_cast<std::size_t>(i)]);
    if (!component) fields.refuse("space directions", words[static_cast<std::size_t>(i)], "numbers");
    vector[i] = *component;
  }
  return vector;
}

/// What the space's own axes are in LPS; spaces without anatomy are taken as they are.
glm::dvec3 signsOf(const NrrdFields& fields) {
  const std::string space = lowerCase(fields.find("space").value_or(""));
  if (space.starts_with("right-anterior-superior") || space == "ras" || space == "rast") return {-1, -1, 1};
  if (space.starts_with("left-anterior-superior") || space == "las" || space == "last") return {1, -1, 1};
  return {1, 1, 1};
}

void readSpaceDirections(const NrrdFields& fields, std::size_t dimension, NrrdHeader& header) {
  const std::string text = fields.at("space directions");
  const std::vector<std::string> directions = splitDirections(fields, text);
  if (directions.size() != dimension)
    fields.refuse("space directions", text, fmt::format("{} vectors, one per axis", dimension));
  for (int axis = 0; axis < 3; ++axis) {
    const std::string& direction = directions[static_cast<std::size_t>(axis)];
    if (lowerCase(direction) == "none") fields.refuse("space directions", text, "\"none\" for the fourth axis only");
    const glm::dvec3 vector = vectorOf(fields, direction);
    const double length = glm::length(vector);
    header.grid.spacingMm[axis] = checkedSpacing(fields, "space directions", direction, length);
    header.directions[axis] = signsOf(fields) * vector / length;
  }
}

void readSpacing(const NrrdFields& fields, std::size_t dimension, NrrdHeader& header) {
  if (fields.find("space directions")) return readSpaceDirections(fields, dimension, header);
  if (!fields.find("spacings")) return;
  const std::vector<std::string> words = fields.words("spacings", dimension);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto spacing = parseNumber(words[axis]);
    if (!spacing) fields.refuse("spacings", words[axis], "numbers");
    header.grid.spacingMm[static_cast<int>(axis)] = checkedSpacing(fields, "spacings", words[axis], *spacing);
  }
}

/// Sets where the data's file starts to matter: after the header if it is attached.
void locateData(const NrrdFields& fields, const std::filesystem::path& path, NrrdHeader& header) {
  const auto named = fields.find("data file");
  if (!named) {
    if (!fields.endsWithBlankLine())
      throw InputError(fmt::format("{}: the header has no blank line at its end", fields.file()));
    header.dataFile = path;
    header.dataOffset = fields.headerBytes();
    return;
  }
  const std::vector<std::string> words = splitWords(*named);
  if (words.empty() || words.front() == "LIST" || named->find('%') != std::string::npos)
    fields.refuse("data file", *named, "one file name; lists and patterns of files are not read");
  header.dataFile = path.parent_path() / *named;
}

/// Offset after `count` more lines of a file: text before the voxels, not a terabyte of it.
std::uint64_t skipLines(const std::filesystem::path& path, std::uint64_t offset, std::int64_t count) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(offset));
  std::string text(kMaximumSkippedText, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  std::size_t at = 0;
  for (; count > 0 && at < text.size(); ++at)
    if (text[at] == '\n') --count;
  if (count > 0)
    throw InputError(fmt::format("{}: field \"line skip\": {} more lines than there are in {} bytes", path.string(),
                                 count, text.size()));
  return offset + at;
}

std::int64_t readSkip(const NrrdFields& fields, const std::string& name, std::int64_t minimum) {
  const auto text = fields.find(name);
  if (!text) return 0;
  const auto value = parseInteger(*text, minimum, std::numeric_limits<std::int64_t>::max());
  if (!value) fields.refuse(name, *text, fmt::format("whole numbers from {}", minimum));
  return *value;
}

/// Applies line and byte skip and compares the declared size with the file's length.
void checkLength(const NrrdFields& fields, NrrdHeader& header) {
  const std::string place = header.dataFile.string();
  const std::uint64_t length = fileLength(header.dataFile);
  if (const std::int64_t lines = readSkip(fields, "line skip", 0))
    header.dataOffset = skipLines(header.dataFile, header.dataOffset, lines);
  const std::uint64_t available = length - std::min(length, header.dataOffset);
  const std::uint64_t declared = header.voxelBytes();

  if (header.gzip) {
    // Byte skip counts decoded bytes here.
    header.skippedBytes = static_cast<std::uint64_t>(readSkip(fields, "byte skip", 0));
    const std::uint64_t limit = available * kMaximumDeflateRatio;
    if (declared > limit || header.skippedBytes > limit - declared)
      throw InputError(fmt::format("{}: the header declares {} bytes of voxels after {} skipped, more than {} bytes of "
                                   "gzip can hold",
                                   place, declared, header.skippedBytes, available));
    return;
  }
  const std::int64_t skip = readSkip(fields, "byte skip", -1);
  // -1: the voxels are the end of the file.
  const std::uint64_t skipped =
      skip >= 0 ? static_cast<std::uint64_t>(skip) : available - std::min(available, declared);
  if (skipped > available || available - skipped != declared)
    throw InputError(fmt::format("{}: found {} bytes of voxels, expected {} as the header declares", place,
                                 available - std::min(available, skipped), declared));
  header.dataOffset += skipped;
}

} // namespace

std::uint64_t NrrdHeader::voxelBytes() const {
  return static_cast<std::uint64_t>(grid.voxelCount()) * sizeOf(type) * static_cast<std::uint64_t>(timeSteps);
}

NrrdHeader readNrrdHeader(const std::filesystem::path& path, std::uint64_t maximumBytes) {
  const NrrdFields fields(path);
  NrrdHeader header;
  const std::size_t dimension = dimensionOf(fields);
  header.type = typeOf(fields);
  header.gzip = isGzip(fields);
  header.bigEndian = isBigEndian(fields, header.type);
  refuseOtherKinds(fields, dimension);
  readSizes(fields, dimension, header);
  readSpacing(fields, dimension, header);
  checkedVoxelBytes(fields.file(), header.grid, header.type, header.timeSteps, maximumBytes);
  locateData(fields, path, header);
  checkLength(fields, header);
  return header;
}

} // namespace volmark
