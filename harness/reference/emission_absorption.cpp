#include "reference/cell_walk.h"
#include "reference/cubic.h"
#include "reference/medium.h"
#include "reference/reference.h"
#include "reference/scanlines.h"
#include "reference/shading.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace volmark::reference {

namespace {

/// What all rays of a picture share.
struct Emission {
  const Scene& scene;
  const Light& light;
  const Field& field;
  const Medium& medium;
  double voxelMm; // the length that opacity refers to
};

/// Light gathered from the front to the back.
struct Gathered {
  glm::dvec3 color{0}; // premultiplied
  double transmittance = 1;

  void add(const glm::dvec4& premultiplied) {
    color += transmittance * glm::dvec3(premultiplied);
    transmittance *= 1 - premultiplied.a;
  }
  glm::dvec4 result() const { return glm::dvec4(color, 1 - transmittance); }
};

/// How samples at `t` respond to the light.
Response responseAt(const Emission& emission, const Path& path, double t) {
  const ShadingModel model = emission.scene.shading.model;
  if (model == ShadingModel::none) return {};
  const glm::dvec3 gradient = emission.field.gradient(emission.field.toVoxel(path.at(t)));
  return respondToGradient(model, emission.light, gradient, -path.direction);
}

/// Lights a premultiplied colour.
glm::dvec4 lit(const Response& response, const glm::dvec4& premultiplied) {
  return glm::dvec4(response.factor * glm::dvec3(premultiplied) + response.offset * premultiplied.a, premultiplied.a);
}

double valueAt(const Emission& emission, const Path& path, double t) {
  return emission.field.value(emission.field.toVoxel(path.at(t)));
}

bool stopsEarly(const VolumeSamples& samples, const Gathered& gathered) {
  return samples.earlyTermination && 1 - gathered.transmittance >= samples.terminationOpacity;
}

glm::dvec4 alongPoints(const Emission& emission, const Path& path, const VolumeSamples& samples) {
  const double step = samples.stepVoxels * emission.voxelMm;
  Gathered gathered;
  const auto place = [&](long i) { return path.boxEntry + double(i) * step; };
  const long first = static_cast<long>(std::ceil((path.entry - path.boxEntry) / step));
  for (long i = first; place(i) < path.exit && !stopsEarly(samples, gathered); ++i) {
    const double t = place(i);
    const glm::dvec4 sample = emission.medium.evaluate(valueAt(emission, path, t));
    if (sample.a <= 0) continue;
    const double opacity = 1 - std::pow(1 - sample.a, samples.stepVoxels);
    gathered.add(lit(responseAt(emission, path, t), glm::dvec4(glm::dvec3(sample) * opacity, opacity)));
  }
  return gathered.result();
}

/// A whole step's slab, shortened to a share of the step.
glm::dvec4 shortened(const glm::dvec4& slab, double share) {
  if (slab.a <= 0) return slab;
  const double opacity = 1 - std::pow(1 - slab.a, share);
  return glm::dvec4(glm::dvec3(slab) * (opacity / slab.a), opacity);
}

glm::dvec4 alongSlabs(const Emission& emission, const Path& path, const VolumeSamples& samples) {
  const double step = samples.stepVoxels * emission.voxelMm;
  Gathered gathered;
  if (path.entry == path.exit) return gathered.result();
  double front = valueAt(emission, path, path.entry);
  double start = path.entry;
  const long whole = static_cast<long>(std::floor((path.entry - path.boxEntry) / step));
  for (long i = whole + 1; start < path.exit && !stopsEarly(samples, gathered); ++i) {
    const double end = std::min(path.boxEntry + double(i) * step, path.exit);
    const double back = valueAt(emission, path, end);
    glm::dvec4 slab = emission.medium.slab(front, back, samples.stepVoxels);
    const double share = std::min((end - start) / step, 1.0);
    if (slab.a > 0) {
      if (start == path.entry || end == path.exit) slab = shortened(slab, share);
      gathered.add(lit(responseAt(emission, path, start), slab));
    }
    front = back;
    start = end;
  }
  return gathered.result();
}

/// Cuts [0,1] where the scalar turns and where the transfer function bends: in between, colour and opacity are smooth
/// and monotone along the ray. `cuts` are the ends of the pieces, ascending.
void cutAtBends(const Cubic& cubic, const std::vector<double>& bends, std::vector<double>& cuts) {
  cuts.clear();
  double start = 0;
  for (const double end : monotoneEnds(cubic)) {
    if (end <= start) continue;
    const double low = std::min(cubic(start), cubic(end));
    const double high = std::max(cubic(start), cubic(end));
    for (auto bend = std::upper_bound(bends.begin(), bends.end(), low); bend != bends.end() && *bend < high; ++bend)
      cuts.push_back(crossing(cubic, *bend, start, end));
    cuts.push_back(end);
    start = end;
  }
  std::sort(cuts.begin(), cuts.end());
}

/// The part of a path in one cell, each piece between cuts as `count` slabs of equal length, lit at their middles.
glm::dvec4 cellAsSlabs(const Emission& emission, const Path& path, const CellSpan& span, const Cubic& cubic,
                       const std::vector<double>& cuts, int count) {
  const double length = span.end - span.start;
  Gathered gathered;
  double start = 0;
  double front = cubic(0);
  for (const double end : cuts) {
    const double share = (end - start) / count;
    for (int i = 0; i < count; ++i) {
      const double back = cubic(i + 1 < count ? start + (i + 1) * share : end);
      const glm::dvec4 slab = emission.medium.slab(front, back, share * length / emission.voxelMm);
      front = back;
      if (slab.a <= 0) continue;
      const double middle = span.start + (start + (i + 0.5) * share) * length;
      gathered.add(lit(responseAt(emission, path, middle), slab));
    }
    start = end;
  }
  return gathered.result();
}

double largestDifference(const glm::dvec4& a, const glm::dvec4& b) {
  const glm::dvec4 difference = glm::abs(a - b);
  return std::max({difference.r, difference.g, difference.b, difference.a});
}

glm::dvec4 converged(const Emission& emission, const Path& path, double tolerance) {
  // At 64 slabs only a jump of the shading can be left, and it is worth less than 1/64 of the cell.
  constexpr int kFewestSlabs = 2;
  constexpr int kMostSlabs = 64;
  // What lies behind can't change the ray by more than a small part of the tolerance.
  const double opaque = 0.01 * tolerance;

  Gathered gathered;
  CellWalk walk(emission.field, path);
  CellSpan span;
  std::vector<double> cuts;
  while (gathered.transmittance > opaque && walk.next(span)) {
    if (span.end <= span.start) continue;
    const Cubic cubic = cubicAlong(emission.field.corners(span.cell), span.from, span.to);
    if (emission.medium.isTransparent(cubic.lowerBound(), cubic.upperBound())) continue;
    cutAtBends(cubic, emission.medium.bends(), cuts);

    // Halve the slabs until the cell changes by less than its share of the ray's tolerance.
    const double allowed = tolerance * (span.end - span.start) / (path.exit - path.entry);
    glm::dvec4 cell = cellAsSlabs(emission, path, span, cubic, cuts, kFewestSlabs);
    for (int count = 2 * kFewestSlabs; count <= kMostSlabs; count *= 2) {
      const glm::dvec4 finer = cellAsSlabs(emission, path, span, cubic, cuts, count);
      const double change = gathered.transmittance * largestDifference(finer, cell);
      cell = finer;
      if (change <= allowed) break;
    }
    gathered.add(cell);
  }
  return gathered.result();
}

glm::dvec4 integrate(const Emission& emission, const Path& path, const VolumeSamples& samples) {
  switch (samples.form) {
  case VolumeSamples::Form::point: return alongPoints(emission, path, samples);
  case VolumeSamples::Form::preintegrated: return alongSlabs(emission, path, samples);
  case VolumeSamples::Form::converged: return converged(emission, path, samples.tolerance);
  }
  return glm::dvec4(0);
}

} // namespace

Picture renderVolume(const Scene& scene, const FrameInputs& inputs, int view, int width, int height,
                     const VolumeSamples& samples) {
  assert(view >= 0 && view < static_cast<int>(inputs.views.size()) && width > 0 && height > 0);
  assert(inputs.transferFunction && samples.stepVoxels > 0 && samples.tolerance > 0);
  const Grid& grid = scene.volume->grid();
  const Field field(scene, inputs.timeStep);
  const Medium medium(*inputs.transferFunction);
  const double voxelMm = std::min({grid.spacingMm.x, grid.spacingMm.y, grid.spacingMm.z});
  const Emission emission{scene, inputs.light, field, medium, voxelMm};
  Picture picture(width, height);
  forEachScanline(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const auto path = pathThroughPixel(grid, inputs.clippingPlanes, inputs.views[static_cast<std::size_t>(view)], x,
                                         y, width, height);
      if (path) picture.color[picture.index(x, y)] = glm::vec4(integrate(emission, *path, samples));
    }
  });
  return picture;
}

} // namespace volmark::reference
