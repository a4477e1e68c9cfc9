// volmark info: what a volume file holds.
#include "cli/commands.h"
#include "scenario/scenario.h"
#include "scenario/scene_library.h"
#include "volume/histogram.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

namespace volmark {

namespace {

constexpr int kRows = 16;
constexpr int kBarColumns = 50;
constexpr int kJsonBins = 256;

struct InfoArguments {
  std::string volume;
  std::vector<std::string> data;
  bool json = false;
  double maximumGib = kDefaultMaximumGib;
};

std::string sizeText(double bytes) {
  constexpr const char* units[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
  std::size_t unit = 0;
  for (; bytes >= 1024 && unit < 4; ++unit)
    bytes /= 1024;
  return fmt::format("{:.{}f} {}", bytes, unit == 0 ? 0 : 1, units[unit]);
}

void printHistogram(const Histogram& histogram) {
  fmt::print("  histogram (bars grow with the logarithm of the number of voxels)\n");
  const double most =
      std::log1p(static_cast<double>(*std::max_element(histogram.counts.begin(), histogram.counts.end())));
  const double width = (histogram.range.maximum - histogram.range.minimum) / kRows;
  for (int row = 0; row < kRows; ++row) {
    const std::uint64_t count = histogram.counts[static_cast<std::size_t>(row)];
    const int length = static_cast<int>(std::round(std::log1p(static_cast<double>(count)) / most * kBarColumns));
    fmt::print("  {:>12.5g} {:<{}} {}\n", histogram.range.minimum + row * width, std::string(length, '#'), kBarColumns,
               count);
  }
  fmt::print("  {:>12.5g}\n", histogram.range.maximum);
}

void print(const Volume& volume) {
  const Grid& grid = volume.grid();
  const glm::dvec3 extent = grid.extentMm();
  const double bytes = static_cast<double>(volume.voxels().size()) * volume.timeSteps();
  fmt::print("{}\n", volume.name());
  fmt::print("  voxels     {} x {} x {}", grid.dims.x, grid.dims.y, grid.dims.z);
  if (volume.timeSteps() > 1) fmt::print(", {} time steps", volume.timeSteps());
  fmt::print("\n  type       {}, {}\n", nameOf(volume.type()), sizeText(bytes));
  fmt::print("  spacing    {:.6g} x {:.6g} x {:.6g} mm\n", grid.spacingMm.x, grid.spacingMm.y, grid.spacingMm.z);
  fmt::print("  extent     {:.6g} x {:.6g} x {:.6g} mm\n", extent.x, extent.y, extent.z);
  const Histogram histogram = histogramOf(volume, kRows);
  fmt::print("  range      {:.7g} to {:.7g}, mean {:.6g}\n", histogram.range.minimum, histogram.range.maximum,
             histogram.mean);
  fmt::print("  identity   {}\n", volume.identity());
  for (const std::string& note : volume.notes())
    fmt::print("  note       {}\n", note);
  printHistogram(histogram);
}

void printJson(const Volume& volume) {
  const Grid& grid = volume.grid();
  const Histogram histogram = histogramOf(volume, kJsonBins);
  const nlohmann::json document = {
      {"volmark_info", 1},
      {"name", volume.name()},
      {"dims", {grid.dims.x, grid.dims.y, grid.dims.z}},
      {"time_steps", volume.timeSteps()},
      {"type", nameOf(volume.type())},
      {"spacing_mm", {grid.spacingMm.x, grid.spacingMm.y, grid.spacingMm.z}},
      {"range", {histogram.range.minimum, histogram.range.maximum}},
      {"mean", histogram.mean},
      {"histogram", histogram.counts},
      {"identity", volume.identity()},
      {"notes", volume.notes()},
  };
  fmt::print("{}\n", document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

int info(const InfoArguments& arguments) {
  const Places places = findPlaces();
  SceneLibrary scenes(places.scenes);
  const nlohmann::json name = arguments.volume;
  const SceneDescription& scene = scenes.get(JsonValue(name, "info")).description;
  const auto volume = openVolume(scene, dataFolders(arguments.data, places), bytesOfGib(arguments.maximumGib));
  arguments.json ? printJson(*volume) : print(*volume);
  return 0;
}

} // namespace

void addInfoCommand(CLI::App& app, int& exitCode) {
  auto arguments = std::make_shared<InfoArguments>();
  CLI::App* command = app.add_subcommand("info", "Show size, type, spacing, range and histogram of a volume");
  command->footer(
      "Formats: NRRD (.nrrd, .nhdr; raw, gzip); through ITK: MetaImage (.mha, .mhd), NIfTI-1 (.nii, .nii.gz),\n"
      "legacy VTK images (.vtk), a folder with one DICOM series. Anatomical volumes are turned so that x, y, z\n"
      "point to the patient's left, back and crown; headerless raw files need a scene file.");
  command->add_option("VOLUME", arguments->volume, "Volume file, DICOM folder, scene name or scene file")->required();
  command->add_option("--data", arguments->data, "Folder with volumes, before VOLMARK_DATA and scenes/data");
  command->add_flag("--json", arguments->json, "As JSON, with a histogram of 256 bins");
  command->add_option("--max-volume-gib", arguments->maximumGib, "Largest volume to load")->capture_default_str();
  command->callback([arguments, &exitCode] { exitCode = info(*arguments); });
}

} // namespace volmark
