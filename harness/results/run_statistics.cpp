#include "results/run_document.h"

#include <cmath>
#include <map>
#include <set>

namespace volmark {

namespace {

using Json = nlohmann::ordered_json;
using FrameValue = double FrameRow::*;

std::vector<double> valuesOf(const std::vector<const FrameRow*>& frames, FrameValue value) {
  std::vector<double> values;
  for (const FrameRow* frame : frames)
    if (!std::isnan(frame->*value)) values.push_back(frame->*value);
  return values;
}

// Null if no frame has the value.
Json summary(const std::vector<const FrameRow*>& frames, FrameValue value) {
  const auto values = valuesOf(frames, value);
  if (values.empty()) return nullptr;
  const Statistics statistics = statisticsOf(values);
  return {{"count", statistics.count},
          {"mean_ms", statistics.meanMs},
          {"median_ms", statistics.medianMs},
          {"p99_ms", statistics.p99Ms},
          {"low1_avg_ms", statistics.low1AvgMs},
          {"low1_integral_ms", statistics.low1IntegralMs},
          {"fps", statistics.fps},
          {"clock_mean_ms", statistics.clockMeanMs},
          {"min_ms", statistics.minMs},
          {"max_ms", statistics.maxMs}};
}

Json orbitMeans(const std::vector<const FrameRow*>& headline) {
  std::map<int, std::vector<const FrameRow*>> orbits;
  for (const FrameRow* frame : headline)
    orbits[frame->orbit].push_back(frame);
  const auto meanOf = [](const std::vector<const FrameRow*>& frames, FrameValue value) -> Json {
    const auto values = valuesOf(frames, value);
    return values.empty() ? Json(nullptr) : Json(statisticsOf(values).meanMs);
  };
  Json means = Json::array();
  for (const auto& [orbit, frames] : orbits)
    means.push_back({{"orbit", orbit},
                     {"frames", frames.size()},
                     {"frame_ms", meanOf(frames, &FrameRow::frameMs)},
                     {"cpu_ms", meanOf(frames, &FrameRow::cpuMs)}});
  return means;
}

// Over all breakdown frames, so that the means of a frame's passes add up: where a pass didn't run it took 0 ms.
Json passSummaries(const std::vector<const FrameRow*>& breakdown, const TechniqueInfo& info) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<double>> times;
  const auto add = [&](const std::string& name) -> std::vector<double>& {
    const auto [place, isNew] = times.try_emplace(name, breakdown.size(), 0.0);
    if (isNew) order.push_back(name);
    return place->second;
  };
  for (const PassDescriptor& pass : info.passes)
    add(pass.name);
  for (std::size_t i = 0; i < breakdown.size(); ++i)
    for (const PassTime& pass : breakdown[i]->passes)
      add(pass.name)[i] += pass.ms;

  Json summaries = Json::object();
  if (breakdown.empty()) return summaries;
  for (const std::string& name : order) {
    const Statistics statistics = statisticsOf(times[name]);
    summaries[name] = {{"mean_ms", statistics.meanMs}, {"median_ms", statistics.medianMs}};
  }
  return summaries;
}

std::optional<double> stampsRatio(const std::vector<const FrameRow*>& headline,
                                  const std::vector<const FrameRow*>& breakdown) {
  const auto plain = valuesOf(headline, &FrameRow::frameMs);
  const auto stamped = valuesOf(breakdown, &FrameRow::frameMs);
  if (plain.empty() || stamped.empty()) return std::nullopt;
  const double plainMs = statisticsOf(plain).meanMs;
  if (plainMs <= 0) return std::nullopt;
  return statisticsOf(stamped).meanMs / plainMs;
}

} // namespace

nlohmann::ordered_json statisticsDocument(std::span<const FrameRow> frames, const TechniqueInfo& info) {
  std::vector<const FrameRow*> headline, breakdown;
  for (const FrameRow& frame : frames) {
    if (frame.orbitKind == OrbitKind::headline) headline.push_back(&frame);
    if (frame.orbitKind == OrbitKind::breakdown) breakdown.push_back(&frame);
  }
  std::set<double> poses;
  std::set<int> orbits;
  int disturbed = 0;
  for (const FrameRow* frame : headline) {
    poses.insert(frame->phase);
    orbits.insert(frame->orbit);
    if (!frame->disturbed.empty()) ++disturbed;
  }
  const std::optional<double> ratio = stampsRatio(headline, breakdown);

  Json flags = Json::array();
  if (poses.size() < static_cast<std::size_t>(kPosesForLow1)) flags.push_back("insufficient_frames");
  if (ratio && *ratio > kStampsRatioLimit) flags.push_back("stamps_ratio");
  if (disturbed > 0) flags.push_back("disturbed");

  return {{"frames", headline.size()},
          {"poses", poses.size()},
          {"orbits", orbits.size()},
          {"flags", flags},
          {"frame", summary(headline, &FrameRow::frameMs)},
          {"host", summary(headline, &FrameRow::hostMs)},
          {"interval", summary(headline, &FrameRow::intervalMs)},
          {"cpu", summary(headline, &FrameRow::cpuMs)},
          {"update", summary(headline, &FrameRow::updateMs)},
          {"draw", summary(headline, &FrameRow::drawMs)},
          {"gpu", summary(headline, &FrameRow::gpuMs)},
          {"orbit_means", orbitMeans(headline)},
          {"passes", passSummaries(breakdown, info)},
          {"stamps_ratio", ratio ? Json(*ratio) : Json(nullptr)},
          {"disturbed_frames", disturbed}};
}

} // namespace volmark
