// The CPU reference: double precision, multithreaded, no code shared with what it judges.
#pragma once

#include "volmark/picture.h"
#include "volmark/scene.h"

#include <optional>

namespace volmark::reference {

/// First crossing from outside to inside, or from inside to outside, of the trilinear interpolant along each
/// pixel's ray, within the box of voxel centres and the clipping planes. Each cell's cubic is isolated at its
/// extrema and bisected to double precision. A ray that starts inside (value >= isovalue at the entry) hits
/// at the entry point.
Picture renderIsosurface(const Scene& scene, const FrameInputs& inputs, int view, int width, int height);

/// How a volume is integrated.
struct VolumeSamples {
  enum class Form {
    point,             ///< colour and opacity at entry + i*step, opacity corrected for the step
    preintegrated,     ///< slabs between consecutive samples, the scalar linear in between
    converged,         ///< emission-absorption integral, refined until a ray changes by less than tolerance
  } form = Form::converged;
  double stepVoxels = 1;              ///< point and preintegrated
  bool earlyTermination = false;      ///< point and preintegrated: stop at opacity >= threshold
  double terminationOpacity = 0.99;
  double tolerance = 1e-4;            ///< converged
};

/// Emission-absorption with opacity per voxel length (TransferFunction); premultiplied result.
Picture renderVolume(const Scene& scene, const FrameInputs& inputs, int view, int width, int height,
                     const VolumeSamples& samples);

} // namespace volmark::reference
