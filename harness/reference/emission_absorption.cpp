#include "reference/cell_walk.h"
#include "reference/cubic.h"
#include "reference/medium.h"
#include "reference/reference.h"
#include "reference/scanlines.h"
#include "reference/shading.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <vector>

namespace volmark::reference {

namespace {

/// What all rays of a picture share.
struct Emission {
  const Scene& scene;
  const FrameInputs& inputs;
  const Field& field;
  const Medium& medium; // of what clipping planes keep
  const Medium* beyond; // of what they cut off; null: nothing
  double voxelMm;       // the length that opacity refers to

  /// Whether a place belongs to a segment that is not drawn: that of the voxel nearest to it.
  bool isHidden(const glm::dvec3& place) const {
    if (inputs.hiddenSegments.none() || !scene.volume->labels()) return false;
    const glm::ivec3 last = field.dims() - 1;
    const glm::ivec3 voxel = glm::clamp(glm::ivec3(glm::floor(field.toVoxel(place) + 0.5)), glm::ivec3(0), last);
    return inputs.hiddenSegments[static_cast<std::size_t>(scene.volume->labels()->value(voxel.x, voxel.y, voxel.z))];
  }
};

/// A part of a path, and what it leads through.
struct Portion {
  Path path;
  const Medium& medium;
};

/// The path cut into what is drawn, in order. `inBox` is not cut by the clipping planes.
std::vector<Portion> portionsOf(const Emission& emission, const std::optional<Path>& kept,
                                const std::optional<Path>& inBox) {
  std::vector<Portion> portions;
  if (!emission.beyond) {
    if (kept) portions.push_back({*kept, emission.medium});
    return portions;
  }
  if (!inBox) return portions;
  const auto part = [&](double entry, double exit, const Medium& medium) {
    Path path = *inBox;
    path.entry = entry;
    path.exit = exit;
    portions.push_back({path, medium});
  };
  if (!kept) {
    part(inBox->entry, inBox->exit, *emission.beyond);
    return portions;
  }
  if (inBox->entry < kept->entry) part(inBox->entry, kept->entry, *emission.beyond);
  part(kept->entry, kept->exit, emission.medium);
  if (kept->exit < inBox->exit) part(kept->exit, inBox->exit, *emission.beyond);
  return portions;
}

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

double shareThatArrives(const Emission& emission, const glm::dvec3& place);

/// How samples at `t` respond to the light.
Response responseAt(const Emission& emission, const Path& path, double t) {
  const ShadingModel model = emission.scene.shading.model;
  if (model == ShadingModel::none) return {};
  const glm::dvec3 place = path.at(t);
  Arriving light = arrivingAt(place, emission.inputs.light, emission.scene.volume->grid(), -path.direction);
  if (emission.scene.shading.shadows) light.color *= shareThatArrives(emission, place);
  return respondToGradient(model, light, emission.field.gradient(emission.field.toVoxel(place)), -path.direction);
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

void alongPoints(const Emission& emission, const Portion& portion, const VolumeSamples& samples, Gathered& gathered) {
  const Path& path = portion.path;
  const double step = samples.stepVoxels * emission.voxelMm;
  const auto place = [&](long i) { return path.boxEntry + double(i) * step; };
  const long first = static_cast<long>(std::ceil((path.entry - path.boxEntry) / step));
  for (long i = first; place(i) < path.exit && !stopsEarly(samples, gathered); ++i) {
    const double t = place(i);
    const glm::dvec4 sample = portion.medium.evaluate(valueAt(emission, path, t));
    if (sample.a <= 0 || emission.isHidden(path.at(t))) continue;
    const double opacity = 1 - std::pow(1 - sample.a, samples.stepVoxels);
    gathered.add(lit(responseAt(emission, path, t), glm::dvec4(glm::dvec3(sample) * opacity, opacity)));
  }
}

/// A whole step's slab, shortened to a share of the step.
glm::dvec4 shortened(const glm::dvec4& slab, double share) {
  if (slab.a <= 0) return slab;
  const double opacity = 1 - std::pow(1 - slab.a, share);
  return glm::dvec4(glm::dvec3(slab) * (opacity / slab.a), opacity);
}

void alongSlabs(const Emission& emission, const Portion& portion, const VolumeSamples& samples, Gathered& gathered) {
  const Path& path = portion.path;
  const double step = samples.stepVoxels * emission.voxelMm;
  if (path.entry == path.exit) return;
  double front = valueAt(emission, path, path.entry);
  double start = path.entry;
  const long whole = static_cast<long>(std::floor((path.entry - path.boxEntry) / step));
  for (long i = whole + 1; start < path.exit && !stopsEarly(samples, gathered); ++i) {
    const double end = std::min(path.boxEntry + double(i) * step, path.exit);
    const double back = valueAt(emission, path, end);
    glm::dvec4 slab = portion.medium.slab(front, back, samples.stepVoxels);
    const double share = std::min((end - start) / step, 1.0);
    if (slab.a > 0 && !emission.isHidden(path.at(start)) && !emission.isHidden(path.at(end))) {
      if (start == path.entry || end == path.exit) slab = shortened(slab, share);
      gathered.add(lit(responseAt(emission, path, start), slab));
    }
    front = back;
    start = end;
  }
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

/// Cuts [0,1] where the voxel changes that is nearest: half-way through a cell.
void cutHalfWay(const CellSpan& span, std::vector<double>& cuts) {
  for (int axis = 0; axis < 3; ++axis) {
    const double place = (0.5 - span.from[axis]) / (span.to[axis] - span.from[axis]);
    if (place > 0 && place < 1) cuts.push_back(place);
  }
  std::sort(cuts.begin(), cuts.end());
}

/// The part of a path in one cell, each piece between cuts as `count` slabs of equal length, lit at their middles.
glm::dvec4 cellAsSlabs(const Emission& emission, const Portion& portion, const CellSpan& span, const Cubic& cubic,
                       const std::vector<double>& cuts, int count) {
  const double length = span.end - span.start;
  Gathered gathered;
  double start = 0;
  double front = cubic(0);
  for (const double end : cuts) {
    const double share = (end - start) / count;
    for (int i = 0; i < count; ++i) {
      const double back = cubic(i + 1 < count ? start + (i + 1) * share : end);
      const glm::dvec4 slab = portion.medium.slab(front, back, share * length / emission.voxelMm);
      front = back;
      if (slab.a <= 0) continue;
      const double middle = span.start + (start + (i + 0.5) * share) * length;
      if (emission.isHidden(portion.path.at(middle))) continue;
      gathered.add(lit(responseAt(emission, portion.path, middle), slab));
    }
    start = end;
  }
  return gathered.result();
}

double largestDifference(const glm::dvec4& a, const glm::dvec4& b) {
  const glm::dvec4 difference = glm::abs(a - b);
  return std::max({difference.r, difference.g, difference.b, difference.a});
}

void converged(const Emission& emission, const Portion& portion, double tolerance, Gathered& gathered) {
  const Path& path = portion.path;
  // At 64 slabs only a jump of the shading can be left, and it is worth less than 1/64 of the cell.
  constexpr int kFewestSlabs = 2;
  constexpr int kMostSlabs = 64;
  // What lies behind can't change the ray by more than a small part of the tolerance.
  const double opaque = 0.01 * tolerance;

  CellWalk walk(emission.field, path);
  CellSpan span;
  std::vector<double> cuts;
  while (gathered.transmittance > opaque && walk.next(span)) {
    if (span.end <= span.start) continue;
    const Cubic cubic = cubicAlong(emission.field.corners(span.cell), span.from, span.to);
    if (portion.medium.isTransparent(cubic.lowerBound(), cubic.upperBound())) continue;
    cutAtBends(cubic, portion.medium.bends(), cuts);
    if (emission.inputs.hiddenSegments.any()) cutHalfWay(span, cuts);

    // Halve the slabs until the cell changes by less than its share of the ray's tolerance.
    const double allowed = tolerance * (span.end - span.start) / (path.exit - path.entry);
    glm::dvec4 cell = cellAsSlabs(emission, portion, span, cubic, cuts, kFewestSlabs);
    for (int count = 2 * kFewestSlabs; count <= kMostSlabs; count *= 2) {
      const glm::dvec4 finer = cellAsSlabs(emission, portion, span, cubic, cuts, count);
      const double change = gathered.transmittance * largestDifference(finer, cell);
      cell = finer;
      if (change <= allowed) break;
    }
    gathered.add(cell);
  }
}

/// Opacity is in closed form where the scalar is taken as linear: two slabs between bends follow the cubic.
double transmittanceOf(const Emission& emission, const Portion& portion) {
  constexpr int kSlabs = 2;
  double transmittance = 1;
  CellWalk walk(emission.field, portion.path);
  CellSpan span;
  std::vector<double> cuts;
  while (transmittance > 1e-6 && walk.next(span)) {
    if (span.end <= span.start) continue;
    const Cubic cubic = cubicAlong(emission.field.corners(span.cell), span.from, span.to);
    if (portion.medium.isTransparent(cubic.lowerBound(), cubic.upperBound())) continue;
    cutAtBends(cubic, portion.medium.bends(), cuts);
    if (emission.inputs.hiddenSegments.any()) cutHalfWay(span, cuts);
    double start = 0;
    for (const double end : cuts) {
      const double share = (end - start) / kSlabs;
      const double voxels = share * (span.end - span.start) / emission.voxelMm;
      const double middle = span.start + 0.5 * (start + end) * (span.end - span.start);
      const int slabs = emission.isHidden(portion.path.at(middle)) ? 0 : kSlabs;
      for (int i = 0; i < slabs; ++i)
        transmittance *= 1 - portion.medium.slab(cubic(start + i * share), cubic(start + (i + 1) * share), voxels).a;
      start = end;
    }
  }
  return transmittance;
}

/// Of the spotlight's light, at a place.
double shareThatArrives(const Emission& emission, const glm::dvec3& place) {
  const Grid& grid = emission.scene.volume->grid();
  const glm::dvec3 light = emission.inputs.light.position(grid);
  const auto kept = pathBetween(grid, emission.inputs.clippingPlanes, light, place);
  double share = 1;
  for (const Portion& portion : portionsOf(emission, kept, pathBetween(grid, {}, light, place)))
    share *= transmittanceOf(emission, portion);
  return share;
}

glm::dvec4 integrate(const Emission& emission, const std::vector<Portion>& portions, const VolumeSamples& samples) {
  Gathered gathered;
  for (const Portion& portion : portions) {
    switch (samples.form) {
    case VolumeSamples::Form::point: alongPoints(emission, portion, samples, gathered); break;
    case VolumeSamples::Form::preintegrated: alongSlabs(emission, portion, samples, gathered); break;
    case VolumeSamples::Form::converged: converged(emission, portion, samples.tolerance, gathered); break;
    }
  }
  return gathered.result();
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
  std::optional<Medium> beyond;
  if (scene.functionBeyond) beyond.emplace(*scene.functionBeyond);
  const Emission emission{scene, inputs, field, medium, beyond ? &*beyond : nullptr, voxelMm};
  Picture picture(width, height);
  forEachScanline(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const View& eye = inputs.views[static_cast<std::size_t>(view)];
      const auto kept = pathThroughPixel(grid, inputs.clippingPlanes, eye, x, y, width, height);
      const auto portions = portionsOf(emission, kept, pathThroughPixel(grid, {}, eye, x, y, width, height));
      if (!portions.empty()) picture.color[picture.index(x, y)] = glm::vec4(integrate(emission, portions, samples));
    }
  });
  return picture;
}

} // namespace volmark::reference
