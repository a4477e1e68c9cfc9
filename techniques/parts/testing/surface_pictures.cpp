#include "parts/testing/surface_pictures.h"

#include "reference/reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace volmark::parts {

namespace {

/// Whether a pixel of `other` within one of (x, y) has about this distance, or hits nothing just as this one.
bool isSeenBeside(const Picture& other, int x, int y, float distance, double tolerance) {
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, other.height - 1); ++j)
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, other.width - 1); ++i) {
      const float found = other.distance[other.index(i, j)];
      if (std::isinf(distance) ? std::isinf(found) : std::abs(found - distance) <= tolerance) return true;
    }
  return false;
}

} // namespace

void expectNearReference(const Picture& picture, const Scene& scene, const FrameInputs& inputs) {
  const Picture reference = reference::renderIsosurface(scene, inputs, 0, picture.width, picture.height);
  const glm::dvec3& spacing = scene.volume->grid().spacingMm;
  const double cell = std::max({spacing.x, spacing.y, spacing.z});
  int both = 0, hits = 0, apart = 0, misplaced = 0;
  double color = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const std::size_t i = picture.index(x, y);
      const float mine = picture.distance[i], its = reference.distance[i];
      hits += std::isfinite(its);
      const bool near = std::isinf(mine) ? std::isinf(its) : std::abs(mine - its) <= 0.5 * cell;
      if (near && std::isfinite(mine)) {
        ++both;
        for (int c = 0; c < 3; ++c)
          color += std::abs(picture.color[i][c] - reference.color[i][c]) / 3;
      }
      if (near) continue;
      ++apart;
      // A silhouette may lie a pixel beside; the slope of a surface seen edge-on does the rest.
      if (!isSeenBeside(reference, x, y, mine, 2 * cell) || !isSeenBeside(picture, x, y, its, 2 * cell)) ++misplaced;
    }
  EXPECT_EQ(misplaced, 0);
  EXPECT_LE(apart, 0.03 * picture.width * picture.height);
  EXPECT_GE(both, 0.95 * hits);
  if (both > 0) {
    EXPECT_LE(color / both, 0.02);
  }
}

} // namespace volmark::parts
