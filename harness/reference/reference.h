// The CPU reference: double precision, multithreaded, no code shared with what it judges.
#pragma once

#include "volmark/picture.h"
#include "volmark/scene.h"

namespace volmark::reference {

/// First point with value >= isovalue of the trilinear interpolant along each pixel's ray, within the box of voxel
/// centres and the clipping planes. Each cell's cubic is isolated at its extrema and bisected to double precision. A
/// ray that starts inside (value >= isovalue at the entry) hits at the entry point; where the eye itself is inside,
/// that is the eye, and the normal points back along the ray. Values are clamped, so an isovalue <= 0 is inside
/// everywhere and one > 1 nowhere; in between clamping moves no crossing. An axis of one voxel leaves a plane, of
/// which rays see one point. Colours have alpha 1; misses are 0 and infinitely far.
Picture renderIsosurface(const Scene& scene, const FrameInputs& inputs, int view, int width, int height);

/// How a volume is integrated.
struct VolumeSamples {
  enum class Form {
    /// Colour and opacity at i*step from the entry into the box (not behind clipping planes), opacity corrected for the
    /// step.
    point,
    preintegrated, ///< slabs between these places, the scalar linear in between; clipping planes and exit cut slabs
    converged,     ///< emission-absorption integral, refined until a ray changes by less than tolerance
  } form = Form::converged;
  double stepVoxels = 1;         ///< point and preintegrated
  bool earlyTermination = false; ///< point and preintegrated: stop at opacity >= threshold
  double terminationOpacity = 0.99;
  double tolerance = 1e-4; ///< converged
};

/// With scene.shading.shadows, a sample is lit by what the volume lets through on the straight way from the spotlight,
/// clipping planes included. With scene.functionBeyond, what clipping planes cut off has that transfer function.
/// Samples, slabs (by their ends; converged, by their middles) of hidden segments are left out.
/// Emission-absorption with opacity per voxel length (TransferFunction); premultiplied colours, `distance` stays
/// infinite. Samples are shaded with scene.shading.model: at the sample, at a slab's front sample, or, converged,
/// everywhere. Converged rays are cut at cell boundaries, at the scalar's extrema and where it meets a control point;
/// the parts are cut into 2 to 64 slabs until a cell changes by less than its share of `tolerance`. Rays end where less
/// than 0.01 * tolerance passes. A path of no length (an axis of one voxel) gathers nothing.
Picture renderVolume(const Scene& scene, const FrameInputs& inputs, int view, int width, int height,
                     const VolumeSamples& samples);

} // namespace volmark::reference
