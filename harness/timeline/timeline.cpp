#include "timeline/timeline.h"

#include "volmark/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace volmark {

namespace {

bool equal(const Pose& a, const Pose& b) {
  return a.position == b.position && a.right == b.right && a.up == b.up && a.forward == b.forward;
}

/// A jump, as opposed to rounding at the seam of a closed orbit.
bool apart(const Pose& a, const Pose& b) {
  const double scale = std::max(glm::length(a.position), 1e-12);
  return glm::length(a.position - b.position) > 1e-6 * scale || glm::length(a.forward - b.forward) > 1e-6;
}

/// Distance at which a sphere around the target touches the sides of the smaller field of view.
double fitDistance(double radius, const Frustum& frustum) {
  const double tangent = std::min(frustum.right, frustum.up);
  return radius / std::sin(std::atan(tangent));
}

/// Place between key poses: the last key reached and the share of the way to the next.
struct KeyPlace {
  std::size_t key;
  double share;
};

KeyPlace placeBetweenKeys(double phase, std::size_t keys) {
  assert(keys > 0);
  const double along = std::clamp(phase, 0.0, 1.0) * static_cast<double>(keys - 1);
  // Phases i/(n-1) must reach the keys that they stand for.
  const double key = std::min(std::floor(along + 1e-9), static_cast<double>(keys - 1));
  return {static_cast<std::size_t>(key), std::max(0.0, along - key)};
}

CameraPath::Key interpolate(const std::vector<CameraPath::Key>& keys, double phase) {
  const auto [index, share] = placeBetweenKeys(phase, keys.size());
  const CameraPath::Key& from = keys[index];
  // Before a cut the camera stays where it is.
  if (share == 0 || index + 1 == keys.size() || keys[index + 1].cut) return from;
  const CameraPath::Key& to = keys[index + 1];
  return {.azimuthDegrees = glm::mix(from.azimuthDegrees, to.azimuthDegrees, share),
          .elevationDegrees = glm::mix(from.elevationDegrees, to.elevationDegrees, share),
          .distanceScale = glm::mix(from.distanceScale, to.distanceScale, share)};
}

/// Looks at the centre. At the poles the camera's up still follows the azimuth.
Pose poseAround(const Framing& framing, double azimuthDegrees, double elevationDegrees, double distance) {
  const glm::dvec3 up = glm::normalize(framing.up);
  const glm::dvec3 front = glm::normalize(framing.front - up * glm::dot(framing.front, up));
  const glm::dvec3 side = glm::cross(up, front);
  const double azimuth = glm::radians(azimuthDegrees);
  const double elevation = glm::radians(elevationDegrees);
  const glm::dvec3 level = front * std::cos(azimuth) + side * std::sin(azimuth);

  Pose pose;
  pose.forward = -(level * std::cos(elevation) + up * std::sin(elevation));
  pose.right = side * std::cos(azimuth) - front * std::sin(azimuth);
  pose.up = glm::cross(pose.right, pose.forward);
  pose.position = -pose.forward * distance;
  return pose;
}

} // namespace

Timeline::Timeline(const PointSettings& settings, const Scene& scene)
    : m_settings(settings.timeline), m_camera(settings.camera), m_stereo(settings.stereo),
      m_framing(settings.scene.framing),
      m_frustum(Frustum::symmetric(settings.camera.verticalFovDegrees, settings.width, settings.height)),
      m_timeSteps(scene.volume->timeSteps()), m_transferFunction(settings.transferFunction), m_light(settings.light),
      m_hiddenSegments(settings.hiddenSegments) {
  const Grid& grid = scene.volume->grid();
  // A volume of one voxel has no radius: look at it from a voxel's length.
  const double radius = std::max(grid.boundingRadiusMm(), 0.5 * grid.smallestSpacingMm());
  m_distanceMm = settings.camera.distanceMm.value_or(fitDistance(radius, m_frustum));
  if (settings.isovalue)
    m_isovalueFrom = m_isovalueTo = normalisedIsovalue(*settings.isovalue, scene);
  else
    m_isovalueFrom = m_isovalueTo = 0.5;
  if (const auto& sweep = settings.timeline.isovalueSweep) {
    m_isovalueFrom = normalisedIsovalue(sweep->first, scene);
    m_isovalueTo = normalisedIsovalue(sweep->second, scene);
  }
}

Pose Timeline::poseAt(double phase) const {
  const CameraPath& path = m_settings.camera;
  if (path.kind == CameraPath::Kind::keys) {
    const CameraPath::Key key = interpolate(path.keys, phase);
    return poseAround(m_framing, key.azimuthDegrees, key.elevationDegrees, m_distanceMm * key.distanceScale);
  }
  const double turned = path.kind == CameraPath::Kind::orbit ? 360 * path.revolutions * phase : 0;
  return poseAround(m_framing, path.startAzimuthDegrees + turned, path.elevationDegrees, m_distanceMm);
}

double Timeline::isovalueAt(double phase) const {
  return glm::mix(m_isovalueFrom, m_isovalueTo, phase);
}

int Timeline::timeStepAt(double phase) const {
  if (!m_settings.playTimeSteps) return 0;
  return std::clamp(static_cast<int>(std::floor(phase * m_timeSteps + 1e-9)), 0, m_timeSteps - 1);
}

double Timeline::blendAt(double phase) const {
  if (!m_settings.blend) return 0;
  return 0.5 + 0.5 * std::sin(2 * std::numbers::pi * m_settings.blend->cycles * phase);
}

FrameInputs Timeline::at(double phase) const {
  assert(phase >= 0 && phase <= 1);
  FrameInputs inputs;
  const Pose centre = poseAt(phase);
  const int views = m_stereo.enabled ? 2 : 1;
  for (int i = 0; i < views; ++i) {
    View view{centre, m_frustum, i};
    if (m_stereo.enabled) view.pose.position += centre.right * (m_stereo.interpupillaryDistanceMm * (i - 0.5));
    inputs.views.push_back(view);
  }
  inputs.isovalue = isovalueAt(phase);
  inputs.transferFunction = m_transferFunction;
  if (const auto& blend = m_settings.blend)
    inputs.transferFunction =
        std::make_shared<TransferFunction>(TransferFunction::blend(*m_transferFunction, *blend->to, blendAt(phase)));
  inputs.clippingPlanes = m_settings.clippingPlanes;
  inputs.timeStep = timeStepAt(phase);
  inputs.light = m_light;
  inputs.hiddenSegments = m_hiddenSegments;
  return inputs;
}

bool Timeline::jumpsBetween(double previousPhase, double phase) const {
  const CameraPath& path = m_settings.camera;
  const bool wraps = phase < previousPhase;
  if (wraps && apart(poseAt(1), poseAt(0))) return true;
  if (path.kind != CameraPath::Kind::keys) return false;
  const std::size_t before = placeBetweenKeys(previousPhase, path.keys.size()).key;
  const std::size_t now = placeBetweenKeys(phase, path.keys.size()).key;
  const auto cutWithin = [&](std::size_t after, std::size_t last) {
    for (std::size_t key = after + 1; key <= last; ++key)
      if (path.keys[key].cut) return true;
    return false;
  };
  return wraps ? cutWithin(before, path.keys.size() - 1) || cutWithin(0, now) : cutWithin(before, now);
}

Changes Timeline::between(double previousPhase, double phase) const {
  return {.camera = !equal(poseAt(previousPhase), poseAt(phase)),
          .isovalue = isovalueAt(previousPhase) != isovalueAt(phase),
          .transferFunction = blendAt(previousPhase) != blendAt(phase),
          .clippingPlanes = false,
          .timeStep = timeStepAt(previousPhase) != timeStepAt(phase),
          .light = false,
          .segments = false,
          .cut = jumpsBetween(previousPhase, phase)};
}

double Timeline::phaseOf(int frame, int frames) const {
  assert(frame >= 0 && frame < frames);
  const bool ends = m_settings.camera.kind == CameraPath::Kind::keys || m_settings.isovalueSweep.has_value();
  if (!ends) return double(frame) / frames;
  return frames == 1 ? 0 : double(frame) / (frames - 1);
}

Scene makeScene(const PointSettings& settings, std::shared_ptr<const Volume> volume) {
  Scene scene;
  scene.name = settings.scene.name;
  scene.visualisationRange = settings.scene.visualisationRange.value_or(volume->dataRange());
  if (!(scene.visualisationRange.minimum < scene.visualisationRange.maximum))
    throw InputError(
        fmt::format("scene \"{}\": all voxels are {}, so that a \"visualisation_range\" [smallest, largest] "
                    "has to be given",
                    settings.scene.name, scene.visualisationRange.minimum));
  scene.shading = settings.shading;
  if (!settings.timeline.clippingPlanes.empty()) scene.functionBeyond = settings.functionBeyond;
  scene.volume = std::move(volume);
  return scene;
}

double normalisedIsovalue(const Isovalue& isovalue, const Scene& scene) {
  const double value = isovalue.raw ? scene.normalised(isovalue.value) : isovalue.value;
  if (value >= 0 && value <= 1) return value;
  const Range& range = scene.visualisationRange;
  if (isovalue.raw)
    throw InputError(fmt::format("scene \"{}\": isovalue: found raw {}, allowed: the visualisation range {} to {}",
                                 scene.name, isovalue.value, range.minimum, range.maximum));
  throw InputError(fmt::format("scene \"{}\": isovalue: found normalized {}, allowed: 0 to 1 (the visualisation range "
                               "{} to {})",
                               scene.name, isovalue.value, range.minimum, range.maximum));
}

} // namespace volmark
