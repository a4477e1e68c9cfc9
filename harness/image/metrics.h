// How far two pictures are apart.
#pragma once

#include "volmark/picture.h"

#include <optional>

namespace volmark {

/// Errors of one captured picture against the reference.
struct PictureErrors {
  double mse = 0;
  std::optional<double> psnrDb;  ///< absent if mse is 0
  bool identical = false;        ///< colours are bit-equal
  std::optional<double> ssim;    ///< mean structural similarity, 1 if alike; absent under 11 pixels a side
  double flip = 0;               ///< mean LDR-FLIP, 0 if alike, up to 1
  std::optional<double> flipHdr; ///< mean HDR-FLIP; absent where no colour exceeds 1: flip says it all then
  // isosurfaces only:
  std::optional<double> depthMeanVoxels; ///< over pixels that both hit
  std::optional<double> depthP995Voxels;
  std::optional<double> depthMaxVoxels;
  std::optional<double> missedShare;   ///< reference hits, technique does not; of reference hits
  std::optional<double> spuriousShare; ///< technique hits, reference does not; of reference hits
};

/// All colour errors, of the pictures over `background`. MSE, PSNR and SSIM (ssim.h) of the colours clamped to [0,1]
/// and sRGB-encoded, peak 1, mean over the three channels; LDR-FLIP (flip.h) of the same colours, HDR-FLIP before
/// clamping. A NaN against a number is as wrong as can be: squared error 1, SSIM 0, FLIP 1 there, and around it the
/// number's opposite; two NaN are alike. Sizes must be equal (asserted).
PictureErrors compareColor(const Picture& picture, const Picture& reference, const glm::dvec3& background);

/// Adds depth errors (in voxels of `voxelMm`; absent if no pixel hits in both) and the shares of missed and spurious
/// pixels (absent if the reference hits nothing). Both pictures need `distance`.
void compareDistance(const Picture& picture, const Picture& reference, double voxelMm, PictureErrors& errors);

} // namespace volmark
