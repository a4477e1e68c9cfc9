// The names that exr.h defines, shared by writer and reader.
#pragma once

#include <array>
#include <string>

namespace volmark::exr {

inline constexpr std::array<const char*, 4> kColorNames = {"R", "G", "B", "A"};
inline constexpr const char* kDistanceName = "Z";
inline constexpr const char* kFormatAttribute = "volmark.format";
inline constexpr int kFormatVersion = 1;

/// "R" or, of the second view, "right.R".
inline std::string channelName(std::size_t view, const char* name) {
  return view == 0 ? name : std::string("right.") + name;
}

/// Library errors can span lines; ours don't.
inline std::string oneLine(std::string text) {
  for (char& character : text)
    if (character == '\n' || character == '\r') character = ' ';
  return text;
}

} // namespace volmark::exr
