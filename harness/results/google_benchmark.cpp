// Writes what Google Benchmark's compare.py reads: a repetition is an orbit, a name is a point.
#include "results/index.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace volmark {

namespace {

using Json = nlohmann::ordered_json;

struct Orbit {
  double frames = 0;
  double frameMs = 0;
  double cpuMs = 0;
};

std::string nameOf(const std::string& experiment, const nlohmann::json& run, const std::vector<std::string>& axes) {
  std::string name = experiment;
  for (const std::string& axis : axesOf(run, axes))
    name += fmt::format("/{}:{}", axis, run.at("labels").value(axis, ""));
  return name;
}

// What a point was measured with; replicates share it.
std::string setupOf(const nlohmann::json& run) {
  return textAt(run, "/provenance/program/digest") + ' ' + textAt(run, "/technique/module_digest") + ' ' +
         textAt(run, "/provenance/device/identity");
}

// Completed runs by point, in order; of each point only those of the build and device that were used last.
std::vector<std::vector<const nlohmann::json*>> latestRuns(const std::vector<nlohmann::json>& runs) {
  std::vector<std::vector<const nlohmann::json*>> points;
  std::map<std::string, std::size_t> places;
  for (const auto& run : runs) {
    if (textAt(run, "/status") != "completed") continue;
    const auto [place, isNew] = places.try_emplace(textAt(run, "/point"), points.size());
    if (isNew) points.emplace_back();
    points[place->second].push_back(&run);
  }
  for (auto& point : points) {
    const auto* latest = *std::max_element(point.begin(), point.end(), [](const auto* a, const auto* b) {
      return textAt(*a, "/provenance/started") < textAt(*b, "/provenance/started");
    });
    std::erase_if(point, [setup = setupOf(*latest)](const auto* run) { return setupOf(*run) != setup; });
  }
  return points;
}

std::vector<Orbit> orbitsOf(const std::vector<const nlohmann::json*>& replicates) {
  std::vector<Orbit> orbits;
  for (const auto* run : replicates) {
    const nlohmann::json::json_pointer place("/statistics/orbit_means");
    if (!run->contains(place)) continue;
    for (const auto& orbit : run->at(place))
      orbits.push_back({numberAt(orbit, "/frames").value_or(0), numberAt(orbit, "/frame_ms").value_or(0),
                        numberAt(orbit, "/cpu_ms").value_or(0)});
  }
  return orbits;
}

double meanOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double medianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

// Of a sample: over n - 1.
double deviationOf(const std::vector<double>& values) {
  const double mean = meanOf(values);
  double squares = 0;
  for (double value : values)
    squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

double variationOf(const std::vector<double>& values) {
  const double mean = meanOf(values);
  return mean > 0 ? deviationOf(values) / mean : 0;
}

struct Aggregate {
  const char* name;
  const char* unit;
  double (*of)(const std::vector<double>& values);
};
const Aggregate kAggregates[] = {
    {"mean", "time", meanOf},
    {"median", "time", [](const std::vector<double>& values) { return medianOf(values); }},
    {"stddev", "time", deviationOf},
    {"cv", "percentage", variationOf},
};

void addEntries(Json& benchmarks, const std::string& name, int family, const std::vector<Orbit>& orbits) {
  const Json common{{"name", name},     {"family_index", family},  {"per_family_instance_index", 0},
                    {"run_name", name}, {"run_type", "iteration"}, {"repetitions", orbits.size()}};
  std::vector<double> frameMs, cpuMs;
  for (const Orbit& orbit : orbits) {
    Json entry = common;
    entry["repetition_index"] = frameMs.size();
    entry["threads"] = 1;
    entry["iterations"] = static_cast<std::int64_t>(orbit.frames);
    entry["real_time"] = orbit.frameMs;
    entry["cpu_time"] = orbit.cpuMs;
    entry["time_unit"] = "ms";
    benchmarks.push_back(std::move(entry));
    frameMs.push_back(orbit.frameMs);
    cpuMs.push_back(orbit.cpuMs);
  }
  // Like Google Benchmark: no aggregates of a single repetition.
  if (orbits.size() < 2) return;
  for (const Aggregate& aggregate : kAggregates) {
    Json entry = common;
    entry["name"] = fmt::format("{}_{}", name, aggregate.name);
    entry["run_type"] = "aggregate";
    entry["threads"] = 1;
    entry["aggregate_name"] = aggregate.name;
    entry["aggregate_unit"] = aggregate.unit;
    entry["iterations"] = orbits.size();
    entry["real_time"] = aggregate.of(frameMs);
    entry["cpu_time"] = aggregate.of(cpuMs);
    entry["time_unit"] = "ms";
    benchmarks.push_back(std::move(entry));
  }
}

Json contextOf(const nlohmann::json& latest) {
  const std::string governor = textAt(latest, "/provenance/host/governor");
  const nlohmann::json::json_pointer load("/provenance/host/load_average");
  return {{"date", textAt(latest, "/provenance/started")},
          {"host_name", textAt(latest, "/provenance/host/name")},
          {"executable", "volmark"},
          {"num_cpus", static_cast<int>(numberAt(latest, "/provenance/host/logical_cores").value_or(0))},
          {"mhz_per_cpu", std::lround(numberAt(latest, "/provenance/host/frequency_mhz").value_or(0))},
          {"cpu_scaling_enabled", !governor.empty() && governor != "performance"},
          {"caches", Json::array()},
          {"load_avg", latest.contains(load) ? Json(latest.at(load)) : Json::array()},
          {"library_build_type", textAt(latest, "/provenance/build/type") == "Debug" ? "debug" : "release"},
          {"volmark_format", "volmark.google_benchmark 1"},
          {"volmark_version", textAt(latest, "/provenance/program/version")},
          {"volmark_commit", textAt(latest, "/provenance/program/commit")},
          {"volmark_device", textAt(latest, "/provenance/device/identity")}};
}

} // namespace

nlohmann::ordered_json googleBenchmark(const std::string& experiment, const std::vector<nlohmann::json>& runs,
                                       const std::vector<std::string>& axes) {
  const auto points = latestRuns(runs);
  std::map<std::string, int> uses;
  for (const auto& point : points)
    ++uses[nameOf(experiment, *point.front(), axes)];

  Json benchmarks = Json::array();
  nlohmann::json latest = nlohmann::json::object();
  int family = 0;
  for (const auto& point : points) {
    std::string name = nameOf(experiment, *point.front(), axes);
    // Points of different blocks may have the same labels.
    if (uses[name] > 1) name += fmt::format("/point:{}", textAt(*point.front(), "/point").substr(0, 8));
    addEntries(benchmarks, name, family++, orbitsOf(point));
    for (const auto* run : point)
      if (textAt(*run, "/provenance/started") >= textAt(latest, "/provenance/started")) latest = *run;
  }
  return {{"context", contextOf(latest)}, {"benchmarks", benchmarks}};
}

} // namespace volmark
