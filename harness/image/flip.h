// The difference that a viewer sees who alternates between two pictures.
// LDR-FLIP: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: FLIP: A Difference Evaluator for
// Alternating Images, 2020. HDR-FLIP: Andersson, Nilsson, Shirley, Akenine-Möller: Visualizing Errors in Rendered
// High Dynamic Range Images, 2021.
#pragma once

#include "image/plane.h"

#include <vector>

namespace volmark {

/// Pixels per degree of visual angle: a screen of 3840 pixels and 0.7 m width seen from 0.7 m, as in the papers.
inline constexpr double kPixelsPerDegree = 3840 * 0.017453292519943295;

/// LDR-FLIP of every pixel, in [0,1]. The planes are linear Rec.709 in [0,1]. Symmetric.
Plane flipMap(const Planes& picture, const Planes& reference, double pixelsPerDegree = kPixelsPerDegree);

/// The exposures of HDR-FLIP, in stops: from where the brightest pixel of the reference is tone-mapped to 0.85 to where
/// the median one is, about one stop apart, two at least. Just 0 if the reference is black.
/// Differs from the paper: a median of 0 has no exposure, so that it is then taken over the pixels that are not
/// black; infinite pixels don't count.
std::vector<double> flipExposures(const Planes& reference);

/// HDR-FLIP of every pixel, in [0,1]: the largest LDR-FLIP over the exposures of the reference, each tone-mapped as
/// ACES (Narkowicz's fit). The planes are linear Rec.709; what is below 0 counts as 0.
Plane hdrFlipMap(const Planes& picture, const Planes& reference, double pixelsPerDegree = kPixelsPerDegree);

} // namespace volmark
