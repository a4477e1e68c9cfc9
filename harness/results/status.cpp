#include "results/status.h"

#include "results/claim.h"
#include "results/files.h"
#include "results/index.h"
#include "results/run_document.h"
#include "volmark/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace volmark {

namespace {

namespace fs = std::filesystem;

/// What the experiment asks for, by labels and replicate: run.json keeps both when points are renumbered.
using Place = std::pair<std::string, int>;

nlohmann::json readExperiment(const fs::path& folder) {
  const fs::path file = folder / "experiment.json";
  const auto document = readJson(file);
  if (!document || !document->is_object() || textAt(*document, "/format") != "volmark.experiment")
    throw InputError(fmt::format("{}: found no experiment.json in it, allowed: an experiment's folder, as in "
                                 "results/quick",
                                 folder.string()));
  if (numberAt(*document, "/version") != kFormatVersion)
    throw InputError(fmt::format("{}: /version: found {}, allowed: {}", file.string(),
                                 document->value("version", nlohmann::json()).dump(), kFormatVersion));
  return *document;
}

std::map<Place, int> plannedRuns(const nlohmann::json& experiment) {
  std::map<Place, int> planned;
  for (const auto& point : experiment.value("points", nlohmann::json::array()))
    for (int i = 0; i < static_cast<int>(numberAt(point, "/replicates").value_or(1)); ++i)
      planned[{point.value("labels", nlohmann::json::object()).dump(), i}] =
          static_cast<int>(numberAt(point, "/index").value_or(0));
  return planned;
}

std::map<Place, const nlohmann::json*> latestRuns(const std::vector<nlohmann::json>& runs) {
  std::map<Place, const nlohmann::json*> latest;
  for (const nlohmann::json& run : runs) {
    const Place place{run.value("labels", nlohmann::json::object()).dump(),
                      static_cast<int>(numberAt(run, "/replicate").value_or(0))};
    const auto [found, isNew] = latest.emplace(place, &run);
    const auto startOf = [](const nlohmann::json& one) { return textAt(one, "/provenance/started"); };
    if (!isNew && startOf(run) > startOf(*found->second)) found->second = &run;
  }
  return latest;
}

std::vector<ActiveProcess> processesAtWork(const fs::path& experiment) {
  std::map<std::pair<std::string, int>, ActiveProcess> processes;
  std::error_code error;
  for (const auto& shelf : fs::directory_iterator(experiment / "runs", error)) {
    for (const auto& entry : fs::directory_iterator(shelf.path(), error)) {
      if (entry.path().extension() != ".claim") continue;
      const ClaimFacts claim = readClaim(entry.path());
      if (!claim.active) continue;
      ActiveProcess& process = processes[{claim.host, claim.pid}];
      const double age = process.runs == 0 ? claim.heartbeatSeconds : process.heartbeatSeconds;
      process = {claim.host, claim.pid, process.runs + 1, std::min(age, claim.heartbeatSeconds)};
    }
  }
  std::vector<ActiveProcess> result;
  for (const auto& [ignored, process] : processes)
    result.push_back(process);
  return result;
}

/// Mean seconds of the completed runs of each technique; "" of all.
class Pace {
public:
  void add(const nlohmann::json& run) {
    const auto seconds = numberAt(run, "/active_seconds");
    if (!seconds) return;
    for (const std::string& key : {textAt(run, "/labels/technique"), std::string()}) {
      auto& [sum, count] = m_sums[key];
      sum += *seconds;
      ++count;
    }
  }
  std::optional<double> secondsOf(const std::string& technique) const {
    for (const std::string& key : {technique, std::string()})
      if (const auto found = m_sums.find(key); found != m_sums.end()) return found->second.first / found->second.second;
    return std::nullopt;
  }

private:
  std::map<std::string, std::pair<double, int>> m_sums;
};

} // namespace

ExperimentStatus readStatus(const fs::path& folder) {
  const nlohmann::json experiment = readExperiment(folder);
  const std::vector<nlohmann::json> runs = readRuns(folder);
  const auto latest = latestRuns(runs);
  ExperimentStatus status;
  status.name = textAt(experiment, "/name");
  status.active = processesAtWork(folder);
  for (const ActiveProcess& process : status.active)
    status.running += process.runs;

  Pace pace;
  std::set<std::string> builds;
  std::set<int> leftPoints;
  std::vector<std::string> leftTechniques;
  for (const auto& [place, index] : plannedRuns(experiment)) {
    ++status.planned;
    const auto found = latest.find(place);
    if (found == latest.end()) {
      leftPoints.insert(index);
      leftTechniques.push_back(nlohmann::json::parse(place.first).value("technique", ""));
      continue;
    }
    const nlohmann::json& run = *found->second;
    const std::string name = textAt(run, "/status");
    int& count = name == "completed" ? status.completed : name == "unsupported" ? status.unsupported : status.failed;
    ++count;
    if (name == "completed") pace.add(run);
    builds.insert(textAt(run, "/provenance/program/digest") + textAt(run, "/provenance/device/identity"));
  }
  status.builds = static_cast<int>(builds.size());
  status.leftPoints.assign(leftPoints.begin(), leftPoints.end());
  const int undone = static_cast<int>(leftTechniques.size());
  status.running = std::min(status.running, undone); // a claim may outlive its run for a moment
  status.left = undone - status.running;
  if (pace.secondsOf("")) {
    double seconds = 0;
    for (const std::string& technique : leftTechniques)
      seconds += *pace.secondsOf(technique);
    status.secondsLeft = seconds / static_cast<double>(std::max<std::size_t>(1, status.active.size()));
  }
  return status;
}

nlohmann::ordered_json statusDocument(const ExperimentStatus& status) {
  auto active = nlohmann::ordered_json::array();
  for (const ActiveProcess& process : status.active)
    active.push_back({{"host", process.host},
                      {"pid", process.pid},
                      {"runs", process.runs},
                      {"heartbeat_seconds", process.heartbeatSeconds}});
  return {{"format", "volmark.status"},
          {"version", kFormatVersion},
          {"name", status.name},
          {"planned", status.planned},
          {"completed", status.completed},
          {"running", status.running},
          {"failed", status.failed},
          {"unsupported", status.unsupported},
          {"left", status.left},
          {"seconds_left",
           status.secondsLeft ? nlohmann::ordered_json(*status.secondsLeft) : nlohmann::ordered_json(nullptr)},
          {"left_points", status.leftPoints},
          {"active", active},
          {"builds", status.builds}};
}

} // namespace volmark
