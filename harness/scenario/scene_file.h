// scenes/<name>.json: where a volume comes from and how it is looked at.
#pragma once

#include "scenario/strict_json.h"
#include "volmark/scene.h"
#include "volume/generators/generator.h"
#include "volume/mesh/voxelise.h"
#include "volume/raw.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace volmark {

/// "normalized" or "raw" (the data's unit).
struct Isovalue {
  bool raw = false;
  double value = 0.5;
};

/// How the camera sees the volume, in the volume's own axes.
struct Framing {
  glm::dvec3 up{0, 1, 0};    ///< axis of the orbit
  glm::dvec3 front{0, 0, 1}; ///< from the centre towards the camera at azimuth 0; orthogonal to up
};

struct GeneratorSource {
  GeneratorSettings settings;
};
struct FileSource {
  std::string file; ///< looked for beside the scene file, then in the data folders; a folder is a DICOM series
};
/// One file per time step.
struct SeriesSource {
  std::vector<std::string> files; ///< in order; "*" in a name stands for several, in natural order
};
/// A closed triangle mesh, voxelised when it is opened.
struct MeshSource {
  std::string file;
  MeshSettings settings;
};
struct RawSource {
  std::string file;
  RawDescription description;
};

/// Labels of the volume's segments: a file, or, beside a generated volume, another generator with the same settings.
struct LabelsSource {
  std::string file;
  std::string generator; ///< if there is no file
};

struct SceneDescription {
  std::string name;
  std::string title;
  std::filesystem::path path; ///< of the scene file; empty for a scene made from a bare volume file
  std::variant<GeneratorSource, FileSource, SeriesSource, MeshSource, RawSource> source;
  std::optional<LabelsSource> labels;
  std::string fetchHint;                   ///< how to get a missing file: "scenes/fetch.py cranium_ct", or empty
  std::string license;                     ///< empty if the scene file names none
  std::optional<Range> visualisationRange; ///< data's unit
  std::vector<std::pair<std::string, Isovalue>> isovalues; ///< in file order; the first is default
  std::vector<std::pair<std::string, TransferFunction>> transferFunctions;
  Framing framing;
  Light light;
  nlohmann::json document; ///< as read; part of the point's identity where it bears on the picture
};

/// Folders that are searched for volumes: --data, then VOLMARK_DATA (':'-separated), then <scenes>/data.
struct DataFolders {
  std::vector<std::filesystem::path> folders;
};

/// Reads and checks a scene file. Without isovalues or transfer functions there are "middle" (normalised 0.5)
/// and "ramp": neither list is empty. Throws InputError.
SceneDescription readScene(const std::filesystem::path& path);

/// Parses {"normalized": x in [0,1]} or {"raw": x}. Throws InputError.
Isovalue parseIsovalue(const JsonValue& value);
/// Parses {"points": [{"value","color","opacity"}...]}. Throws InputError.
TransferFunction parseTransferFunction(const std::string& name, const JsonValue& value);
/// Parses {"headlight","direction","spot","distance","color","ambient"}; headlight defaults to true unless there is a
/// direction. Throws InputError.
Light parseLight(const JsonValue& value);

/// A scene around a bare volume file: isovalue "middle" (normalised 0.5), transfer function "ramp".
SceneDescription sceneForFile(const std::filesystem::path& path);

/// Loads or generates the volume, and its labels. Throws InputError: missing file (names the folders searched and the
/// fetch hint), bad header, over `maximumBytes`.
std::shared_ptr<const Volume> openVolume(const SceneDescription& scene, const DataFolders& data,
                                         std::uint64_t maximumBytes);

/// Where the volume's file is, if it has one and it is there.
std::optional<std::filesystem::path> findVolumeFile(const SceneDescription& scene, const DataFolders& data);

} // namespace volmark
