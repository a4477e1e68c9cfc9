// What a GPU technique draws to, and how it is read back.
#pragma once

#include "volmark/gpu/commands.h"
#include "volmark/picture.h"

namespace volmark::gpu {

inline constexpr VkFormat kColorFormat = VK_FORMAT_R16G16B16A16_SFLOAT;
inline constexpr VkFormat kDepthFormat = VK_FORMAT_R32_SFLOAT;

/// Layered colour and distance images, one layer per view, both in VK_IMAGE_LAYOUT_GENERAL at the start and
/// at the end of every frame, usable as storage image, colour attachment and copy source. The technique must
/// write every pixel. `distance` is along the view direction in world units, +infinity where nothing is.
struct Target {
  Target(Device& device, int width, int height, int views);

  int width;
  int height;
  int views;
  Image color;    ///< kColorFormat: linear Rec.709, premultiplied alpha
  Image distance; ///< kDepthFormat

  /// Records the first transition to GENERAL; once.
  void initialise(Commands& commands) const;
};

/// Copies one view to the host. Waits; never on the timed path.
Picture readBack(Device& device, const Target& target, int view);

} // namespace volmark::gpu
