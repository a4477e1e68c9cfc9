// What a GPU technique draws to, and how it is read back.
#pragma once

#include "volmark/gpu/commands.h"
#include "volmark/picture.h"

#include <vector>

namespace volmark::gpu {

inline constexpr VkFormat kColorFormat = VK_FORMAT_R16G16B16A16_SFLOAT;
inline constexpr VkFormat kDepthFormat = VK_FORMAT_R32_SFLOAT;
inline constexpr VkFormat kNormalFormat = VK_FORMAT_R32G32B32A32_SFLOAT;
inline constexpr VkFormat kStepsFormat = VK_FORMAT_R32_SFLOAT;

/// Layered images, one layer per view, all in VK_IMAGE_LAYOUT_GENERAL at the start and at the end of every frame,
/// usable as storage image, colour attachment and copy source. The technique must write every pixel: of `color` and
/// `distance` in every frame, of `normal` and `steps` in counting frames, if it declares them (they are empty if not).
struct Target {
  Target(Device& device, int width, int height, int views, const std::vector<PictureLayer>& layers = {});

  int width;
  int height;
  int views;
  Image color;    ///< kColorFormat: linear Rec.709, premultiplied alpha
  Image distance; ///< kDepthFormat: along the view direction, world units; +infinity where nothing is
  Image normal;   ///< kNormalFormat: unit, in the world; 0 where nothing is
  Image steps;    ///< kStepsFormat: of each pixel's ray

  /// Records the first transition to GENERAL; once.
  void initialise(Commands& commands) const;
};

/// Copies one view's colours and distances to the host. Waits; never on the timed path.
Picture readBack(Device& device, const Target& target, int view);

/// Copies one view's normals and steps, as far as the target has them, into `picture`. Waits, too.
void readBackLayers(Device& device, const Target& target, int view, Picture& picture);

} // namespace volmark::gpu
