#include "reference/cell_walk.h"
#include "reference/cubic.h"
#include "reference/reference.h"
#include "reference/scanlines.h"
#include "reference/shading.h"

#include <cassert>

namespace volmark::reference {

namespace {

struct Hit {
  double t;
  bool atEntry;
};

/// First point along the path with a clamped value >= isovalue.
std::optional<Hit> firstHit(const Field& field, const Path& path, double isovalue) {
  // Clamped values are never below 0 and never above 1. In between clamping moves no crossing.
  if (isovalue <= 0) return Hit{path.entry, true};
  if (isovalue > 1) return std::nullopt;

  CellWalk walk(field, path);
  CellSpan span;
  for (bool first = true; walk.next(span); first = false) {
    if (field.maximumCorner(span.cell) < isovalue) continue;
    const Cubic cubic = cubicAlong(field.corners(span.cell), span.from, span.to, isovalue);
    if (first && cubic.coefficients[0] >= 0) return Hit{path.entry, true};
    if (const auto s = firstNonNegative(cubic)) return Hit{span.start + *s * (span.end - span.start), false};
  }
  return std::nullopt;
}

glm::dvec3 litSurface(const Scene& scene, const Light& light, const Field& field, const Path& path, const Hit& hit) {
  const ShadingModel model = scene.shading.model;
  const glm::dvec3 place = path.at(hit.t);
  const Arriving arriving = arrivingAt(place, light, scene.volume->grid(), -path.direction);
  const Response response =
      hit.atEntry ? respond(model, arriving, path.entryNormal, -path.direction)
                  : respondToGradient(model, arriving, field.gradient(field.toVoxel(place)), -path.direction);
  return response.lit(scene.shading.surfaceColor);
}

} // namespace

Picture renderIsosurface(const Scene& scene, const FrameInputs& inputs, int view, int width, int height) {
  assert(view >= 0 && view < static_cast<int>(inputs.views.size()) && width > 0 && height > 0);
  const Field field(scene, inputs.timeStep);
  Picture picture(width, height);
  forEachScanline(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const auto path = pathThroughPixel(scene.volume->grid(), inputs.clippingPlanes,
                                         inputs.views[static_cast<std::size_t>(view)], x, y, width, height);
      if (!path) continue;
      const auto hit = firstHit(field, *path, inputs.isovalue);
      if (!hit) continue;
      const std::size_t pixel = picture.index(x, y);
      picture.color[pixel] = glm::vec4(glm::dvec4(litSurface(scene, inputs.light, field, *path, *hit), 1.0));
      picture.distance[pixel] = static_cast<float>(hit->t * path->cosine);
    }
  });
  return picture;
}

} // namespace volmark::reference
