#include "worker/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <optional>

namespace volmark {

namespace {

std::string labelsText(const nlohmann::ordered_json& labels) {
  std::string text;
  for (const auto& [axis, value] : labels.items())
    text += axis == "technique" ? value.get<std::string>() : fmt::format(" {}={}", axis, value.get<std::string>());
  return text;
}

/// Largest (or, negated, smallest) number of a key over the pictures; nothing if none has it.
std::optional<double> worst(const nlohmann::ordered_json& pictures, const char* key, double sign) {
  std::optional<double> result;
  for (const auto& picture : pictures) {
    if (!picture.contains(key) || !picture[key].is_number()) continue;
    const double value = picture[key];
    if (!result || sign * value > sign * *result) result = value;
  }
  return result;
}

std::string failedChecks(const nlohmann::ordered_json& run) {
  std::string text;
  for (const auto& check : run["checks"])
    if (!check["passed"].get<bool>())
      text +=
          fmt::format("; CHECK FAILED {}: {}", check["name"].get<std::string>(), check["detail"].get<std::string>());
  return text;
}

} // namespace

std::string summaryOf(const Experiment& experiment, const RunIdentity& identity) {
  std::ifstream file(experiment.runFolder(identity) / "run.json");
  const auto run = nlohmann::ordered_json::parse(file, nullptr, false);
  if (run.is_discarded()) return identity.run + ": no longer there";
  const std::string head = labelsText(run["labels"]) + ": ";
  if (run["status"] != "completed")
    return head + run["status"].get<std::string>() + ": " + run["reason"].get<std::string>();

  const auto& frame = run["statistics"]["frame"];
  std::string text = fmt::format("{}{:.1f} ms ({:.1f} fps), 1 % low {:.1f} ms", head, frame["mean_ms"].get<double>(),
                                 frame["fps"].get<double>(), frame["low1_avg_ms"].get<double>());
  if (const auto psnr = worst(run["pictures"], "psnr_db", -1)) text += fmt::format(", PSNR {:.1f} dB", *psnr);
  if (const auto flip = worst(run["pictures"], "flip", 1)) text += fmt::format(", FLIP {:.4f}", *flip);
  if (const auto depth = worst(run["pictures"], "depth_p995_voxels", 1))
    text += fmt::format(", depth {:.3f} voxel", *depth);
  return text + failedChecks(run);
}

} // namespace volmark
