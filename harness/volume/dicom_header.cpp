// DICOM files: a walk over the data elements of the top level, as far as the pixels (DICOM PS3.5 section 7, PS3.10).
#include "volmark/error.h"
#include "volume/file_claims.h"
#include "volume/header_text.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <set>

namespace volmark {

namespace {

constexpr std::uint64_t kPreambleBytes = 128;
constexpr std::uint32_t kUndefinedLength = 0xffffffff;
constexpr int kDeepestSequence = 16;
constexpr int kMostElements = 100'000;       // before the pixels, in sequences too
constexpr std::uint32_t kLongestValue = 256; // of the elements that are looked at

constexpr std::uint32_t tag(std::uint32_t group, std::uint32_t element) {
  return group << 16 | element;
}
constexpr std::uint32_t kTransferSyntax = tag(0x0002, 0x0010);
constexpr std::uint32_t kSeries = tag(0x0020, 0x000e);
constexpr std::uint32_t kSamplesPerPixel = tag(0x0028, 0x0002);
constexpr std::uint32_t kFrames = tag(0x0028, 0x0008);
constexpr std::uint32_t kRows = tag(0x0028, 0x0010);
constexpr std::uint32_t kColumns = tag(0x0028, 0x0011);
constexpr std::uint32_t kBitsAllocated = tag(0x0028, 0x0100);
constexpr std::uint32_t kPixels = tag(0x7fe0, 0x0010);
constexpr std::uint32_t kItem = tag(0xfffe, 0xe000);
constexpr std::uint32_t kItemEnd = tag(0xfffe, 0xe00d);
constexpr std::uint32_t kSequenceEnd = tag(0xfffe, 0xe0dd);

const std::string kImplicitLittle = "1.2.840.10008.1.2";
const std::string kExplicitLittle = "1.2.840.10008.1.2.1";
const std::string kExplicitBig = "1.2.840.10008.1.2.2";
/// JPEG, JPEG lossless, JPEG-LS, JPEG 2000 (each lossless or not) and run lengths: what gdcm decodes.
const std::set<std::string> kCompressed = {"1.2.840.10008.1.2.4.50", "1.2.840.10008.1.2.4.51", "1.2.840.10008.1.2.4.57",
                                           "1.2.840.10008.1.2.4.70", "1.2.840.10008.1.2.4.80", "1.2.840.10008.1.2.4.81",
                                           "1.2.840.10008.1.2.4.90", "1.2.840.10008.1.2.4.91", "1.2.840.10008.1.2.5"};
/// The most bytes that a compressed byte may stand for in a slice of more than kEasyBytes: an even slice takes
/// next to nothing, but not a large one.
constexpr std::uint64_t kMaximumRatio = 1000;
constexpr std::uint64_t kEasyBytes = 64u << 20;

struct Element {
  std::uint32_t tag = 0;
  std::uint32_t length = 0;
  bool isSequence = false;
};

/// Reads elements; every length is held against the file's end before it is believed.
class Walk {
public:
  explicit Walk(const std::filesystem::path& path)
      : m_place(path.string()), m_file(path, std::ios::binary), m_length(fileLength(path)),
        m_position(kPreambleBytes + 4) {}

  FileClaim slice;
  std::string series;

  void run() {
    for (;;) {
      if (m_position >= m_length) fail("there are no pixels (7FE0,0010)");
      const std::uint64_t start = m_position;
      Element element = next();
      if (!m_inData && element.tag >> 16 != 0x0002) {
        // The meta information, always explicit and little endian, ends here.
        enterData();
        m_position = start;
        element = next();
      }
      if (element.tag == kPixels) return checkPixels(element);
      if (element.length == kUndefinedLength || element.isSequence)
        skipSequence(element, 0);
      else
        take(element);
    }
  }

private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(fmt::format("{}: {}", m_place, what)); }

  template <std::size_t Size> std::array<std::uint8_t, Size> bytes() {
    std::array<std::uint8_t, Size> result;
    if (m_length - std::min(m_length, m_position) < Size) fail("the file ends within an element");
    read(reinterpret_cast<char*>(result.data()), Size);
    return result;
  }
  void read(char* to, std::size_t count) {
    // A seek, even to the same place, would drop what the stream has read ahead.
    if (m_read != m_position) m_file.seekg(static_cast<std::streamoff>(m_position));
    m_file.read(to, static_cast<std::streamsize>(count));
    if (!m_file) fail("can't be read");
    m_read = m_position += count;
  }
  std::uint32_t number16(std::uint8_t a, std::uint8_t b) const {
    return m_bigEndian ? std::uint32_t(a) << 8 | b : std::uint32_t(b) << 8 | a;
  }
  std::uint32_t number32(const std::array<std::uint8_t, 4>& b) const {
    const std::uint32_t first = number16(b[0], b[1]);
    const std::uint32_t second = number16(b[2], b[3]);
    return m_bigEndian ? first << 16 | second : second << 16 | first;
  }

  Element next() {
    if (++m_elements > kMostElements) fail(fmt::format("more than {} elements before the pixels", kMostElements));
    const auto head = bytes<4>();
    Element element;
    element.tag = tag(number16(head[0], head[1]), number16(head[2], head[3]));
    if (element.tag >> 16 == 0xfffe || !m_explicit) {
      element.length = number32(bytes<4>());
      return element;
    }
    const auto form = bytes<4>();
    const std::string type{static_cast<char>(form[0]), static_cast<char>(form[1])};
    static const std::set<std::string> longTypes = {"OB", "OD", "OF", "OL", "OV", "OW", "SQ",
                                                    "SV", "UC", "UN", "UR", "UT", "UV"};
    element.isSequence = type == "SQ";
    element.length = longTypes.contains(type) ? number32(bytes<4>()) : number16(form[2], form[3]);
    return element;
  }

  void skip(const Element& element) {
    if (element.length > m_length - std::min(m_length, m_position))
      fail(fmt::format("element ({:04X},{:04X}) claims {} bytes, more than the file has", element.tag >> 16,
                       element.tag & 0xffff, element.length));
    m_position += element.length;
  }

  std::string text(const Element& element) {
    const std::uint64_t start = m_position;
    skip(element);
    if (element.length > kLongestValue)
      fail(fmt::format("element ({:04X},{:04X}) of {} bytes, allowed: {}", element.tag >> 16, element.tag & 0xffff,
                       element.length, kLongestValue));
    std::string value(element.length, '\0');
    m_position = start;
    read(value.data(), value.size());
    while (!value.empty() && (value.back() == '\0' || value.back() == ' '))
      value.pop_back();
    return value;
  }
  int shortNumber(const Element& element) {
    if (element.length != 2) fail("a size that is not a 16-bit number");
    const auto two = bytes<2>();
    return static_cast<int>(number16(two[0], two[1]));
  }

  void take(const Element& element) {
    switch (element.tag) {
    case kTransferSyntax: m_syntax = text(element); return;
    case kSeries: series = text(element); return;
    case kRows:
      slice.dims.y = shortNumber(element);
      m_sized |= 1;
      return;
    case kColumns:
      slice.dims.x = shortNumber(element);
      m_sized |= 2;
      return;
    case kBitsAllocated: m_bits = shortNumber(element); return;
    case kSamplesPerPixel: m_samples = shortNumber(element); return;
    case kFrames: {
      const std::string frames = text(element);
      if (std::string(trimmed(frames)) != "1")
        fail(fmt::format("found {} frames in one file, allowed: one slice a file", shown(frames)));
      return;
    }
    default: skip(element);
    }
  }

  bool isPlain() const {
    return m_syntax == kImplicitLittle || m_syntax == kExplicitLittle || m_syntax == kExplicitBig;
  }

  void enterData() {
    m_inData = true;
    if (!isPlain() && !kCompressed.contains(m_syntax))
      fail(fmt::format("found the transfer syntax {}, allowed: uncompressed, JPEG, JPEG-LS, JPEG 2000, RLE; convert it "
                       "with another tool",
                       shown(m_syntax)));
    m_explicit = m_syntax != kImplicitLittle;
    m_bigEndian = m_syntax == kExplicitBig;
  }

  /// Items and sequences of defined length are jumped over; those of undefined length are walked.
  void skipSequence(const Element& sequence, int depth) {
    if (depth == kDeepestSequence) fail(fmt::format("sequences more than {} deep", kDeepestSequence));
    if (sequence.length != kUndefinedLength) return skip(sequence);
    for (;;) {
      const Element item = next();
      if (item.tag == kSequenceEnd) return;
      if (item.tag != kItem) fail("a sequence holds something other than items");
      if (item.length != kUndefinedLength)
        skip(item);
      else
        skipItem(depth);
    }
  }
  void skipItem(int depth) {
    for (;;) {
      const Element element = next();
      if (element.tag == kItemEnd) return;
      if (element.length == kUndefinedLength)
        skipSequence(element, depth + 1);
      else
        skip(element);
    }
  }

  void checkPixels(const Element& pixels) {
    if (m_sized != 3) fail("Rows or Columns is missing");
    if (slice.dims.x < 1 || slice.dims.y < 1)
      fail(fmt::format("found {} columns and {} rows, allowed: at least 1 of each", slice.dims.x, slice.dims.y));
    if (m_samples != 1) fail(fmt::format("found {} samples a pixel, allowed: 1 (grey scale)", m_samples));
    if (m_bits != 8 && m_bits != 16 && m_bits != 32)
      fail(fmt::format("found {} bits allocated, allowed: 8, 16, 32", m_bits));
    slice.scalarBytes = static_cast<std::size_t>(m_bits) / 8;
    if (!isPlain()) return checkFragments(pixels);
    const std::uint64_t padded = (slice.bytes() + 1) / 2 * 2;
    if (pixels.length != slice.bytes() && pixels.length != padded)
      fail(fmt::format("found {} bytes of pixels, expected {} for {} x {}", pixels.length, slice.bytes(), slice.dims.x,
                       slice.dims.y));
    skip(pixels);
  }

  /// Compressed pixels: a table of offsets, then pieces, as a sequence.
  void checkFragments(const Element& pixels) {
    if (pixels.length != kUndefinedLength) fail("compressed pixels that are not in pieces");
    const std::uint64_t start = m_position;
    skipSequence(pixels, 0);
    const std::uint64_t found = m_position - start;
    if (slice.bytes() > std::max(kEasyBytes, found * kMaximumRatio))
      fail(fmt::format("found {} bytes of compressed pixels, too few for {} x {}", found, slice.dims.x, slice.dims.y));
  }

  std::string m_place;
  std::ifstream m_file;
  int m_elements = 0;
  std::uint64_t m_length;
  std::uint64_t m_position; ///< of the next element
  std::uint64_t m_read = 0; ///< of the stream
  bool m_explicit = true;
  bool m_bigEndian = false;
  bool m_inData = false;
  std::string m_syntax = kExplicitLittle;
  int m_sized = 0; ///< bits: rows, columns
  int m_bits = 0;
  int m_samples = 1;
};

} // namespace

bool isDicom(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(kPreambleBytes);
  std::array<char, 4> found{};
  file.read(found.data(), found.size());
  return file && std::string_view(found.data(), found.size()) == "DICM";
}

DicomClaim checkDicom(const std::filesystem::path& path, std::uint64_t maximumBytes) {
  if (!isDicom(path)) throw InputError(fmt::format("{}: not a DICOM file: no \"DICM\" after 128 bytes", path.string()));
  Walk walk(path);
  walk.run();
  checkClaimedSize(path.string(), walk.slice, maximumBytes);
  return {walk.slice, walk.series};
}

} // namespace volmark
