// Structural similarity: Wang, Bovik, Sheikh, Simoncelli: Image Quality Assessment: From Error Visibility to
// Structural Similarity, 2004, section III.B and C.
#pragma once

#include "image/plane.h"

#include <optional>

namespace volmark {

/// Side of the window, in pixels.
inline constexpr int kSsimWindow = 11;

/// How alike `a` and `b` are around every pixel: at most 1, which is alike; 1 for equal planes of equal size. Values
/// are expected in [0,1]. A Gaussian window of standard deviation 1.5, K1 = 0.01, K2 = 0.03. Half a window from the
/// border windows are not whole: meanSsim() leaves those pixels out.
Plane ssimMap(const Plane& a, const Plane& b);

/// Mean of a map over the whole windows; absent if none fits in.
std::optional<double> meanSsim(const Plane& map);

} // namespace volmark
