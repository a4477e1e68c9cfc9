// How far two pictures are apart.
#pragma once

#include "volmark/picture.h"

#include <optional>

namespace volmark {

/// Errors of one captured picture against the reference.
struct PictureErrors {
  double mse = 0;
  std::optional<double> psnrDb; ///< absent if mse is 0
  bool identical = false;       ///< colours are bit-equal
  // isosurfaces only:
  std::optional<double> depthMeanVoxels; ///< over pixels that both hit
  std::optional<double> depthP995Voxels;
  std::optional<double> depthMaxVoxels;
  std::optional<double> missedShare;   ///< reference hits, technique does not; of reference hits
  std::optional<double> spuriousShare; ///< technique hits, reference does not; of reference hits
};

/// MSE and PSNR of the pictures over `background`, clamped to [0,1], sRGB-encoded, peak 1, mean over the three
/// channels. A NaN against a number counts as an error of 1. Sizes must be equal (asserted).
PictureErrors compareColor(const Picture& picture, const Picture& reference, const glm::dvec3& background);

/// Adds depth errors (in voxels of `voxelMm`; absent if no pixel hits in both) and the shares of missed and spurious
/// pixels (absent if the reference hits nothing). Both pictures need `distance`.
void compareDistance(const Picture& picture, const Picture& reference, double voxelMm, PictureErrors& errors);

} // namespace volmark
