// The names that exr.h defines, shared by writer and reader.
#pragma once

#include "volmark/picture.h"

#include <OpenEXR/ImfMultiView.h>

#include <array>
#include <string>
#include <vector>

namespace volmark::exr {

inline constexpr std::array<const char*, 4> kColorNames = {"R", "G", "B", "A"};
inline constexpr const char* kDistanceName = "Z";
inline constexpr std::array<const char*, 3> kNormalNames = {"N.X", "N.Y", "N.Z"};
inline constexpr const char* kStepsName = "steps";
inline constexpr const char* kFormatAttribute = "volmark.format";
inline constexpr int kFormatVersion = 1;

inline const Imf::StringVector kViewNames = {"left", "right"};

/// Of one view "R", "N.X"; of two "R", "N.left.X" and "right.R", "N.right.X".
inline std::string channelName(std::size_t views, std::size_t view, const char* name) {
  return views == 1 ? name : Imf::insertViewName(name, kViewNames, static_cast<int>(view));
}

/// A channel of 32-bit floats in a picture; one number every `stride` bytes.
struct FloatChannel {
  const char* name;
  const float* first;
  std::size_t stride;
};

/// Those of the layers that `picture` has beside its colours.
inline std::vector<FloatChannel> floatChannels(const Picture& picture) {
  std::vector<FloatChannel> channels;
  if (!picture.distance.empty()) channels.push_back({kDistanceName, picture.distance.data(), sizeof(float)});
  if (!picture.normal.empty())
    for (int axis = 0; axis < 3; ++axis)
      channels.push_back({kNormalNames[static_cast<std::size_t>(axis)], &picture.normal[0][axis], sizeof(glm::vec3)});
  if (!picture.steps.empty()) channels.push_back({kStepsName, picture.steps.data(), sizeof(float)});
  return channels;
}

/// Library errors can span lines; ours don't.
inline std::string oneLine(std::string text) {
  for (char& character : text)
    if (character == '\n' || character == '\r') character = ' ';
  return text;
}

} // namespace volmark::exr
