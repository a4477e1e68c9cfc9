// What each frame is given: camera, isovalue, transfer function, clipping planes, time step, light, segments.
#pragma once

#include "scenario/point.h"

namespace volmark {

/// A function of phase in [0,1] over one pass (orbit). Pure: equal phases give equal inputs.
class Timeline {
public:
  /// Throws InputError for an isovalue outside of the visualisation range.
  Timeline(const PointSettings& settings, const Scene& scene);

  FrameInputs at(double phase) const;
  /// What a technique is told between two frames.
  Changes between(double previousPhase, double phase) const;

  /// Phase of frame i of n equal steps: i/n for orbits (the last frame is one step before the first), i/(n-1)
  /// for key poses and sweeps that end.
  double phaseOf(int frame, int frames) const;

private:
  Pose poseAt(double phase) const;
  double isovalueAt(double phase) const;
  int timeStepAt(double phase) const;
  /// Of the other transfer function; 0 without a blend.
  double blendAt(double phase) const;
  /// Whether the camera was cut on the way, or across the seam of two passes.
  bool jumpsBetween(double previousPhase, double phase) const;

  TimelineSettings m_settings;
  CameraSettings m_camera;
  StereoSettings m_stereo;
  Framing m_framing;
  Frustum m_frustum;
  double m_distanceMm = 0;
  double m_isovalueFrom = 0;
  double m_isovalueTo = 0;
  int m_timeSteps = 1;
  std::shared_ptr<const TransferFunction> m_transferFunction;
  Light m_light;
  std::bitset<kMaximumSegments> m_hiddenSegments;
};

/// The Scene that a technique is prepared with. Throws InputError for a volume of one value without a
/// visualisation range.
Scene makeScene(const PointSettings& settings, std::shared_ptr<const Volume> volume);

/// The isovalue, normalised over the scene's visualisation range. Throws InputError outside of [0,1].
double normalisedIsovalue(const Isovalue& isovalue, const Scene& scene);

} // namespace volmark
