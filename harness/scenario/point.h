// One point: all settings of a run, typed. Made by expansion from a scenario.
#pragma once

#include "scenario/scene_file.h"
#include "volmark/parameters.h"
#include "volmark/scene.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace volmark {

struct CameraSettings {
  double verticalFovDegrees = 30;
  std::optional<double> distanceMm; ///< absent: "fit", the bounding sphere fills the smaller field of view
};

struct StereoSettings {
  bool enabled = false;
  double interpupillaryDistanceMm = 60;
};

/// The camera part of a timeline.
struct CameraPath {
  enum class Kind { orbit, fixed, keys } kind = Kind::orbit;
  double revolutions = 1;
  double elevationDegrees = 20;
  double startAzimuthDegrees = 0;
  struct Key {
    double azimuthDegrees = 0;
    double elevationDegrees = 0;
    double distanceScale = 1; ///< of the camera distance
    bool cut = false;         ///< the camera jumps here instead of moving
  };
  std::vector<Key> keys; ///< Kind::keys: at equal intervals, linear in between
};

/// The transfer function moves to another one and back by a sine: share 0.5 + 0.5 sin(2 pi cycles phase) of `to`
/// (Faludi et al. 2021, section 4.5).
struct TransferFunctionBlend {
  std::shared_ptr<const TransferFunction> to; ///< never null
  double cycles = 1;                          ///< over the timeline
};

struct TimelineSettings {
  CameraPath camera;
  std::optional<std::pair<Isovalue, Isovalue>> isovalueSweep; ///< from, to: linear over the timeline
  std::optional<TransferFunctionBlend> blend;
  std::vector<ClippingPlane> clippingPlanes;
  bool playTimeSteps = false; ///< all time steps once over the timeline
};

struct PacingSettings {
  enum class Mode { frames, timed } mode = Mode::frames;
  int frames = 60;          ///< frames: equal steps of one pass over the timeline (an orbit)
  int warmUpFrames = 3;     ///< frames: at least 3
  int orbits = 3;           ///< frames: timed passes over the timeline per process
  double warmUpSeconds = 1; ///< timed: and at least 3 frames
  double seconds = 10;      ///< timed: length of the timeline
};

struct MeasureSettings {
  int replicates = 1;      ///< R: processes
  int breakdownOrbits = 1; ///< extra orbits with a stamp per pass (frames pacing)
  int framesInFlight = 1;
  std::uint64_t seed = 1;
  double timeLimitSeconds = 600; ///< of one run
  double memoryLimitGib = 0;     ///< of one worker process, private memory; 0: none
  int interleave = 4;            ///< most workers alive at once
  /// run: a process each. volume: a worker draws one run after the other as long as the volume stays the same.
  enum class Isolation { run, volume } isolation = Isolation::run;
};

struct PictureSettings {
  int count = 4;                 ///< captured frames, spread evenly over the timeline
  std::string reference = "cpu"; ///< "cpu" or "none"
  glm::dvec3 background{0.0};    ///< linear Rec.709, for metrics and sheets
};

struct PointSettings {
  std::string sceneName; ///< name in the scenes folder, or a path
  std::string technique;
  ParameterValues parameters;
  /// Absent for techniques that draw volumes alone, unless it was given.
  std::optional<Isovalue> isovalue;
  std::shared_ptr<const TransferFunction> transferFunction; ///< resolved; never null
  std::shared_ptr<const TransferFunction> functionBeyond;   ///< of what clipping planes cut off; null: not drawn
  std::bitset<kMaximumSegments> hiddenSegments;             ///< of the scene's labels
  Shading shading;
  Light light;
  int width = 512;
  int height = 512;
  StereoSettings stereo;
  CameraSettings camera;
  TimelineSettings timeline;
  PacingSettings pacing;
  MeasureSettings measure;
  PictureSettings pictures;

  SceneDescription scene; ///< read from the scene file, with the point's own changes
  /// A profile's limit: larger volume files are to be refused. Not part of the configuration.
  std::optional<std::int64_t> maximumVoxels;
};

/// An axis value as shown in tables.
struct Label {
  std::string axis; ///< "technique", "step", ...
  std::string value;
};

struct Point {
  PointSettings settings;
  nlohmann::json config;     ///< resolved, complete, canonical: what is hashed and written
  std::vector<Label> labels; ///< what distinguishes this point within its scenario
  int index = 0;             ///< within its scenario
  int block = 0;
  std::string hash;  ///< config and identity of data: see results/hash.h. Empty until the data is known
  std::string group; ///< points of equal group differ only in technique and are interleaved
};

class TechniqueCatalogue;
/// Reads a complete point configuration (all keys of the schema, defaults where absent) for a technique that
/// `techniques` knows. `file` is for error texts. The configuration of a point gives that point again.
/// Throws InputError.
PointSettings readPoint(const nlohmann::json& config, const std::string& file, const TechniqueCatalogue& techniques,
                        const std::filesystem::path& scenesFolder);

} // namespace volmark
