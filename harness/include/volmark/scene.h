// What is drawn (Scene, fixed while a technique lives) and what each frame is given (FrameInputs).
#pragma once

#include "volmark/transfer_function.h"
#include "volmark/view.h"
#include "volmark/volume.h"

#include <bitset>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace volmark {

/// How surfaces and shaded samples are lit. The formulas are in shaders/volmark/shading.glsl and, written
/// independently, in reference/shading.cpp; harness/README.md defines them.
enum class ShadingModel : std::uint8_t { none, lambert, phong, gooch, ggx };

struct Shading {
  ShadingModel model = ShadingModel::lambert;
  glm::dvec3 surfaceColor{0.85, 0.82, 0.75}; ///< linear Rec.709; isosurfaces only
  bool shadows = false; ///< the volume keeps light from itself; of a spotlight, and TechniqueInfo::shadows only
};

/// A headlight, a light infinitely far away, or a spotlight. `direction` points towards it and is normalised.
struct Light {
  bool headlight = true;         ///< the light comes from the eye; all but colour and ambient are ignored
  glm::dvec3 direction{0, 0, 1}; ///< world space; of a spotlight, from the volume's centre
  bool spot = false;             ///< its cone holds the volume's bounding sphere; it does not fall off
  double distance = 3;           ///< spotlight: from the volume's centre, in radii of that sphere; > 1
  glm::dvec3 color{1.0};         ///< linear Rec.709
  double ambient = 0.1;          ///< share of the colour that needs no light, [0,1]

  bool isSpot() const { return spot && !headlight; }
  /// Of a spotlight, in world space.
  glm::dvec3 position(const Grid& grid) const { return direction * distance * grid.boundingRadiusMm(); }
};

/// A technique gets this once. Scalars are normalised to [0,1] over `visualisationRange` and clamped.
struct Scene {
  std::string name;
  std::shared_ptr<const Volume> volume;
  Range visualisationRange; ///< data's unit; minimum < maximum
  Shading shading;
  /// What clipping planes cut off is drawn with it, if TechniqueInfo::functionBeyond; null: not drawn.
  std::shared_ptr<const TransferFunction> functionBeyond;

  double normalised(double raw) const {
    return (raw - visualisationRange.minimum) / (visualisationRange.maximum - visualisationRange.minimum);
  }
};

/// Keeps the half space dot(normal, p) >= offset. World space.
struct ClippingPlane {
  glm::dvec3 normal{1, 0, 0};
  double offset = 0;
};
inline constexpr int kMaximumClippingPlanes = 6;

/// What the timeline gives a frame; the same for every technique.
struct FrameInputs {
  std::vector<View> views;                                  ///< 1..n; stereo: view 0 is left
  double isovalue = 0.5;                                    ///< normalised; inside is value >= isovalue
  std::shared_ptr<const TransferFunction> transferFunction; ///< never null
  std::vector<ClippingPlane> clippingPlanes;                ///< at most kMaximumClippingPlanes
  int timeStep = 0;
  Light light;
  /// Segments of Volume::labels() that are not drawn, if TechniqueInfo::segments. A sample belongs to the segment of
  /// the voxel that is nearest to it; a slab is drawn only if both its ends are in segments that are.
  std::bitset<kMaximumSegments> hiddenSegments;
};

/// What differs from the previous frame. After reset() everything counts as changed.
struct Changes {
  bool camera = true;
  bool isovalue = true;
  bool transferFunction = true;
  bool clippingPlanes = true;
  bool timeStep = true;
  bool light = true;
  bool segments = true;
  bool cut = true; ///< the camera jumped: temporal prediction is pointless
};

} // namespace volmark
