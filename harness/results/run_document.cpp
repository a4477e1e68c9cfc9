#include "results/run_document.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace volmark {

namespace {

using Json = nlohmann::ordered_json;

Json orNull(std::optional<double> value) {
  return value ? Json(*value) : Json(nullptr);
}

// Not a number is written as null by the JSON library; said here so that nobody relies on it unawares.
Json orNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

std::string oneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char letter) { return letter == '\n' || letter == '\r'; }, ' ');
  return text;
}

std::string nameOf(Draws draws) {
  switch (draws) {
  case Draws::isosurface: return "isosurface";
  case Draws::volume: return "volume";
  case Draws::both: return "both";
  }
  return "";
}

std::string nameOf(History history) {
  switch (history) {
  case History::none: return "none";
  case History::lossless: return "lossless";
  case History::visible: return "visible";
  }
  return "";
}

std::string nameOf(CounterKind kind) {
  switch (kind) {
  case CounterKind::exact: return "exact";
  case CounterKind::perDevice: return "per_device";
  case CounterKind::statistical: return "statistical";
  }
  return "";
}

Json passesDocument(const std::vector<PassDescriptor>& passes) {
  Json document = Json::array();
  for (const PassDescriptor& pass : passes)
    document.push_back({{"name", pass.name}, {"documentation", pass.documentation}});
  return document;
}

Json techniqueDocument(const CatalogueEntry& entry) {
  const TechniqueInfo& info = entry.factory->info;
  Json counters = Json::array();
  for (const CounterDescriptor& counter : info.counters)
    counters.push_back(
        {{"name", counter.name}, {"kind", nameOf(counter.kind)}, {"documentation", counter.documentation}});
  return {{"name", info.name},
          {"family", entry.family},
          {"module_digest", entry.moduleDigest},
          {"summary", info.summary},
          {"paper", info.paper},
          {"section", info.section},
          {"draws", nameOf(info.draws)},
          {"history", nameOf(info.history)},
          {"deterministic", info.deterministic},
          {"needs_gpu", info.needsGpu},
          {"passes", passesDocument(info.passes)},
          {"generation", passesDocument(info.generation)},
          {"counters", counters}};
}

Json generationDocument(const std::vector<GenerationPass>& generation) {
  Json document = Json::array();
  for (const GenerationPass& pass : generation)
    document.push_back({{"name", pass.name}, {"host_ms", orNull(pass.hostMs)}, {"gpu_ms", orNull(pass.gpuMs)}});
  return document;
}

// Mean over the counted frames that have the counter.
Json countersDocument(const std::vector<CounterRow>& rows, const TechniqueInfo& info) {
  std::map<std::string, std::pair<double, int>> sums;
  Json document = Json::object();
  for (const CounterDescriptor& counter : info.counters)
    document[counter.name] = nullptr;
  for (const CounterRow& row : rows) {
    for (const CounterValue& value : row.values) {
      auto& [sum, count] = sums[value.name];
      sum += static_cast<double>(value.value);
      ++count;
    }
  }
  for (const auto& [name, sum] : sums)
    document[name] = sum.first / sum.second;
  return document;
}

Json memoryDocument(const RunRecord& record) {
  Json items = Json::array();
  std::uint64_t total = 0;
  for (const gpu::MemoryItem& item : record.memory) {
    items.push_back({{"name", item.name}, {"bytes", item.bytes}});
    total += item.bytes;
  }
  return {{"items", items},
          {"total_bytes", total},
          {"ledger_bytes", record.ledgerBytes},
          {"ledger_peak_bytes", record.ledgerPeakBytes}};
}

Json pictureDocument(const PictureRow& picture, const TechniqueInfo& info) {
  const bool compared = picture.reference != "none";
  const PictureErrors& errors = picture.errors;
  const auto error = [compared](std::optional<double> value) { return compared ? orNull(value) : Json(nullptr); };
  return {{"frame", picture.frame},
          {"phase", picture.phase},
          {"view", picture.view},
          {"file", picture.file},
          {"reference", picture.reference},
          {"reference_file", picture.referenceFile},
          {"mse", error(errors.mse)},
          {"psnr_db", error(errors.psnrDb)},
          {"identical", compared ? Json(errors.identical) : Json(nullptr)},
          {"ssim", error(errors.ssim)},
          {"flip", error(errors.flip)},
          {"flip_hdr", error(errors.flipHdr)},
          {"depth_mean_voxels", error(errors.depthMeanVoxels)},
          {"depth_p995_voxels", error(errors.depthP995Voxels)},
          {"depth_max_voxels", error(errors.depthMaxVoxels)},
          {"missed_share", error(errors.missedShare)},
          {"spurious_share", error(errors.spuriousShare)},
          {"cumulative_ms", info.history == History::visible ? orNull(picture.cumulativeMs) : Json(nullptr)}};
}

Json turnsDocument(const std::vector<TurnRow>& turns) {
  Json document = Json::array();
  for (const TurnRow& turn : turns)
    document.push_back({{"orbit_kind", turn.orbitKind == OrbitKind::headline ? "headline" : "breakdown"},
                        {"orbit", turn.orbit},
                        {"place", turn.place},
                        {"of", turn.of}});
  return document;
}

// What only a completed run has.
void addMeasurements(Json& document, const RunRecord& record, const TechniqueInfo& info) {
  document["statistics"] = statisticsDocument(record.frames, info);
  document["generation"] = generationDocument(record.generation);
  document["turns"] = turnsDocument(record.turns);
  document["prepare_ms"] = orNull(record.prepareMs);
  document["first_frame_ms"] = orNull(record.firstFrameMs);
  document["counters"] = countersDocument(record.counters, info);
  document["memory"] = memoryDocument(record);
  document["pictures"] = Json::array();
  for (const PictureRow& picture : record.pictures)
    document["pictures"].push_back(pictureDocument(picture, info));
}

constexpr RunStatus kStatuses[] = {RunStatus::completed, RunStatus::failed,      RunStatus::crashed,
                                   RunStatus::timedOut,  RunStatus::unsupported, RunStatus::outOfMemory};

} // namespace

RunStatus runStatusFromName(const std::string& name) {
  for (const RunStatus status : kStatuses)
    if (nameOf(status) == name) return status;
  return RunStatus::failed;
}

std::string nameOf(RunStatus status) {
  switch (status) {
  case RunStatus::completed: return "completed";
  case RunStatus::failed: return "failed";
  case RunStatus::crashed: return "crashed";
  case RunStatus::timedOut: return "timed_out";
  case RunStatus::unsupported: return "unsupported";
  case RunStatus::outOfMemory: return "out_of_memory";
  }
  return "";
}

nlohmann::ordered_json labelsDocument(const std::vector<Label>& labels) {
  Json document = Json::object();
  for (const Label& label : labels)
    document[label.axis] = label.value;
  return document;
}

nlohmann::ordered_json runDocument(const RunIdentity& identity, const Point& point, const CatalogueEntry& technique,
                                   const RunRecord& record) {
  Json document{{"format", "volmark.run"},
                {"version", kFormatVersion},
                {"run", identity.run},
                {"point", identity.point},
                {"replicate", identity.replicate},
                {"point_index", point.index},
                {"group", point.group},
                {"labels", labelsDocument(point.labels)},
                {"status", nameOf(record.status)},
                {"reason", oneLine(record.reason)},
                {"active_seconds", record.activeSeconds},
                {"config", Json(point.config)},
                {"technique", techniqueDocument(technique)}};
  if (record.status == RunStatus::completed) addMeasurements(document, record, technique.factory->info);

  document["checks"] = Json::array();
  for (const RunCheck& check : record.checks)
    document["checks"].push_back({{"name", check.name}, {"passed", check.passed}, {"detail", oneLine(check.detail)}});
  document["provenance"] = Json(record.provenance);
  return document;
}

} // namespace volmark
