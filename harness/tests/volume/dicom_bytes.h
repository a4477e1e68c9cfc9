// DICOM files, element by element, for files that no writer would write.
#pragma once

#include <cstdint>
#include <string>

namespace volmark::test {

/// Explicit little endian elements after the preamble.
class Dicom {
public:
  static constexpr std::uint32_t kOpen = 0xffffffff; ///< length of what ends with a mark of its own
  inline static const std::string kOpenItem{"\xfe\xff\x00\xe0\xff\xff\xff\xff", 8};
  inline static const std::string kItemEnd{"\xfe\xff\x0d\xe0\0\0\0\0", 8};
  inline static const std::string kSequenceEnd{"\xfe\xff\xdd\xe0\0\0\0\0", 8};

  std::string bytes = std::string(128, '\0') + "DICM";

  Dicom& element(std::uint32_t tag, const char* type, const std::string& value) {
    number16(tag >> 16);
    number16(tag & 0xffff);
    bytes += type;
    number16(static_cast<std::uint32_t>(value.size()));
    bytes += value;
    return *this;
  }
  Dicom& longElement(std::uint32_t tag, const char* type, std::uint32_t length, const std::string& value) {
    number16(tag >> 16);
    number16(tag & 0xffff);
    bytes += type;
    number16(0);
    number16(length & 0xffff);
    number16(length >> 16);
    bytes += value;
    return *this;
  }
  /// Claims `length` bytes, whatever it has.
  static std::string item(std::uint32_t length, const std::string& bytes) {
    return kOpenItem.substr(0, 4) + word(length & 0xffff) + word(length >> 16) + bytes;
  }
  static std::string word(std::uint32_t value) {
    return {static_cast<char>(value & 0xff), static_cast<char>(value >> 8 & 0xff)};
  }

private:
  void number16(std::uint32_t value) { bytes += word(value); }
};

/// All that comes before the pixels of 4 x 3 uint16.
inline Dicom slice() {
  Dicom dicom;
  dicom.element(0x00020010, "UI", "1.2.840.10008.1.2.1\0")
      .element(0x0020000e, "UI", "1.2.3.4\0")
      .element(0x00280002, "US", Dicom::word(1))
      .element(0x00280010, "US", Dicom::word(3))
      .element(0x00280011, "US", Dicom::word(4))
      .element(0x00280100, "US", Dicom::word(16));
  return dicom;
}

} // namespace volmark::test
