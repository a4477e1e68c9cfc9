#include "results/index.h"

#include "results/csv.h"
#include "results/files.h"
#include "results/run_document.h"
#include "volmark/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <tuple>

namespace volmark {

namespace {

const nlohmann::json* find(const nlohmann::json& document, const std::string& pointer) {
  const nlohmann::json::json_pointer place(pointer);
  return document.contains(place) ? &document.at(place) : nullptr;
}

std::optional<double> generationMs(const nlohmann::json& run) {
  const auto* passes = find(run, "/generation");
  if (!passes || !passes->is_array()) return std::nullopt;
  double sum = 0;
  for (const auto& pass : *passes)
    sum += numberAt(pass, "/host_ms").value_or(0);
  return sum;
}

// The lowest of the pictures; infinite if all are identical to the reference; nothing without a reference.
std::optional<double> lowestPsnr(const nlohmann::json& run) {
  std::optional<double> lowest;
  const auto* pictures = find(run, "/pictures");
  if (!pictures || !pictures->is_array()) return std::nullopt;
  for (const auto& picture : *pictures) {
    const auto* identical = find(picture, "/identical");
    if (!identical || !identical->is_boolean()) continue;
    const double psnr = numberAt(picture, "/psnr_db").value_or(std::numeric_limits<double>::infinity());
    lowest = std::min(lowest.value_or(psnr), psnr);
  }
  return lowest;
}

// The largest of a key over the pictures, or (sign -1) the smallest; nothing if none has it.
std::optional<double> worst(const nlohmann::json& run, const std::string& key, double sign) {
  std::optional<double> result;
  const auto* pictures = find(run, "/pictures");
  if (!pictures || !pictures->is_array()) return std::nullopt;
  for (const auto& picture : *pictures) {
    const auto value = numberAt(picture, "/" + key);
    if (value && (!result || sign * *value > sign * *result)) result = value;
  }
  return result;
}

void addRow(CsvText& csv, const nlohmann::json& run, const std::vector<std::string>& axes) {
  csv.text(textAt(run, "/run")).text(textAt(run, "/point"));
  csv.integer(static_cast<std::int64_t>(numberAt(run, "/replicate").value_or(0)));
  csv.text(textAt(run, "/status")).text(textAt(run, "/reason"));
  const auto* labels = find(run, "/labels");
  for (const std::string& axis : axes)
    csv.text(labels ? labels->value(axis, "") : "");
  for (const char* name : {"mean_ms", "median_ms", "p99_ms", "low1_avg_ms", "fps"})
    csv.number(numberAt(run, fmt::format("/statistics/frame/{}", name)));
  csv.number(numberAt(run, "/statistics/host/median_ms")).number(numberAt(run, "/statistics/cpu/median_ms"));
  csv.number(lowestPsnr(run)).number(worst(run, "ssim", -1)).number(worst(run, "flip", 1));
  csv.number(worst(run, "flip_hdr", 1)).number(generationMs(run)).number(numberAt(run, "/memory/total_bytes"));
  csv.text(textAt(run, "/provenance/device/identity")).text(textAt(run, "/provenance/program/commit"));
  csv.text(textAt(run, "/provenance/started"));
  csv.endRow();
}

} // namespace

std::string textAt(const nlohmann::json& document, const std::string& pointer) {
  const auto* value = find(document, pointer);
  return value && value->is_string() ? value->get<std::string>() : std::string();
}

std::optional<double> numberAt(const nlohmann::json& document, const std::string& pointer) {
  const auto* value = find(document, pointer);
  return value && value->is_number() ? std::optional(value->get<double>()) : std::nullopt;
}

std::vector<std::string> axesOf(const nlohmann::json& run, const std::vector<std::string>& axes) {
  std::vector<std::string> found;
  const auto* labels = find(run, "/labels");
  if (!labels || !labels->is_object()) return found;
  for (const std::string& axis : axes)
    if (labels->contains(axis)) found.push_back(axis);
  for (const auto& label : labels->items())
    if (std::find(axes.begin(), axes.end(), label.key()) == axes.end()) found.push_back(label.key());
  return found;
}

void requireVersion(const nlohmann::json& run, const std::filesystem::path& file) {
  const auto* version = find(run, "/version");
  if (!version || *version != kFormatVersion)
    throw InputError(fmt::format("{}: /version: found {}, allowed: {}", file.string(),
                                 version ? version->dump() : "nothing", kFormatVersion));
}

std::vector<nlohmann::json> readRuns(const std::filesystem::path& experiment) {
  namespace fs = std::filesystem;
  std::vector<nlohmann::json> runs;
  std::error_code error;
  for (const auto& shelf : fs::directory_iterator(experiment / "runs", error)) {
    if (!shelf.is_directory()) continue;
    for (const auto& folder : fs::directory_iterator(shelf.path(), error)) {
      // Folders that start with a point are still being written.
      if (folder.path().filename().string().starts_with('.')) continue;
      auto run = readJson(folder.path() / "run.json");
      if (!run || !run->is_object()) continue;
      requireVersion(*run, folder.path() / "run.json");
      runs.push_back(std::move(*run));
    }
  }
  const auto place = [](const nlohmann::json& run) {
    return std::tuple(numberAt(run, "/point_index").value_or(std::numeric_limits<double>::infinity()),
                      textAt(run, "/point"), numberAt(run, "/replicate").value_or(0), textAt(run, "/run"));
  };
  std::sort(runs.begin(), runs.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
  return runs;
}

std::string indexCsv(const std::vector<nlohmann::json>& runs, const std::vector<std::string>& axes) {
  std::vector<std::string> allAxes = axes;
  for (const auto& run : runs)
    for (const std::string& axis : axesOf(run, allAxes))
      if (std::find(allAxes.begin(), allAxes.end(), axis) == allAxes.end()) allAxes.push_back(axis);

  std::vector<std::string> columns{"run", "point", "replicate", "status", "reason"};
  for (const std::string& axis : allAxes)
    columns.push_back("label." + axis);
  for (const char* name :
       {"mean_ms", "median_ms", "p99_ms", "low1_avg_ms", "fps", "host_median_ms", "cpu_median_ms", "psnr_db", "ssim",
        "flip", "flip_hdr", "generation_ms", "memory_bytes", "device", "commit", "started"})
    columns.emplace_back(name);

  CsvText csv("index", columns);
  for (const auto& run : runs)
    addRow(csv, run, allAxes);
  return csv.str();
}

} // namespace volmark
