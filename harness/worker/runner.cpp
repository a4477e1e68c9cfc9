#include "worker/runner.h"

#include "results/provenance.h"
#include "timeline/timeline.h"
#include "volmark/error.h"
#include "worker/batch.h"
#include "worker/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <thread>
#include <utility>

namespace volmark {

std::atomic<bool> interruptRequested{false};

namespace {

void refuseOverLimit(const PointSettings& settings, const Volume& volume) {
  const auto voxels = static_cast<std::int64_t>(volume.grid().voxelCount());
  if (settings.maximumVoxels && voxels > *settings.maximumVoxels)
    throw InputError(fmt::format("scene \"{}\": found {} voxels, allowed: {} (limits.voxels of the profile)",
                                 settings.scene.name, voxels, *settings.maximumVoxels));
}

/// Those to run now, in the scenario's order.
std::vector<Point*> chosenPoints(Scenario& scenario, const RunnerOptions& options, std::size_t builds) {
  std::vector<Point*> chosen;
  for (Point& point : scenario.points) {
    const int number = point.index / static_cast<int>(builds);
    if (!options.points || std::binary_search(options.points->begin(), options.points->end(), number))
      chosen.push_back(&point);
  }
  return chosen;
}

/// Loads each distinct volume once: bad data stops here, and the identities name the points.
void identifyPoints(const std::vector<Point*>& chosen, const RunnerOptions& options) {
  std::map<std::string, std::vector<Point*>> byVolume;
  for (Point* point : chosen) {
    byVolume[volumeKeyOf(*point)].push_back(point);
  }
  for (const auto& [key, points] : byVolume) {
    const auto volume = openVolume(points.front()->settings.scene, options.data, options.maximumBytes);
    for (Point* point : points) {
      refuseOverLimit(point->settings, *volume);
      Timeline(point->settings, makeScene(point->settings, volume)); // isovalue within the range, or one line
      point->hash = pointHash(point->config, volume->identity());
    }
  }
}

/// Device part of the run hash, by whether a technique needs one. Empty text if there is no usable device:
/// the runs then become rows with that reason.
class DeviceIdentities {
public:
  explicit DeviceIdentities(const std::string& selector) : m_selector(selector) {}

  const std::string& of(const TechniqueInfo& info) {
    if (!info.needsGpu) return m_host;
    if (!m_gpu) {
      m_gpu = "no device";
      try {
        const gpu::Device device(gpu::DeviceOptions{m_selector, false});
        m_gpu = deviceIdentity(&device.facts());
      } catch (const UnsupportedError&) {
      }
    }
    return *m_gpu;
  }

private:
  std::string m_selector;
  std::string m_host = deviceIdentity(nullptr);
  std::optional<std::string> m_gpu;
};

std::vector<Build> openBuilds(const TechniqueCatalogue& catalogue, const std::vector<BuildChoice>& choices) {
  std::vector<Build> builds;
  std::set<std::string> names;
  for (const BuildChoice& choice : choices) {
    if (!names.insert(choice.name).second)
      throw InputError(fmt::format("--build {0}: found twice, allowed: a name of its own for each build", choice.name));
    builds.emplace_back(choice);
  }
  if (builds.empty()) builds.emplace_back(catalogue);
  return builds;
}

/// Named builds are an axis of the experiment like any other: `build`, behind `technique`. Point i * builds + b is
/// point i of the expansion, run by build b.
void addBuildAxis(Scenario& scenario, const std::vector<Build>& builds) {
  if (builds.front().name().empty()) return;
  if (std::find(scenario.axes.begin(), scenario.axes.end(), "build") != scenario.axes.end())
    throw InputError(
        fmt::format("{}: found an axis \"build\", allowed beside --build: any other name", scenario.file.string()));
  scenario.axes.insert(scenario.axes.begin() + 1, "build");
  std::vector<Point> points;
  for (const Point& point : scenario.points) {
    for (const Build& build : builds) {
      points.push_back(point);
      points.back().labels.insert(points.back().labels.begin() + 1, {"build", build.name()});
      points.back().index = static_cast<int>(points.size()) - 1;
    }
  }
  scenario.points = std::move(points);
}

using BatchPlan = std::vector<const Point*>;

/// Points that are interleaved, in the scenario's order; split where too many would live at once, but never between
/// the builds of a point, which follow one another.
std::vector<BatchPlan> batchesOf(const std::vector<Point*>& points, std::size_t builds) {
  std::vector<BatchPlan> batches;
  std::map<std::string, std::size_t> open; // group -> batch that still has room
  for (std::size_t i = 0; i < points.size(); i += builds) {
    const Point& point = *points[i];
    const auto room = static_cast<std::size_t>(point.settings.measure.interleave);
    const auto found = open.find(point.group);
    const bool fits = found != open.end() && batches[found->second].size() + builds <= room;
    if (!fits) {
      open[point.group] = batches.size();
      batches.emplace_back();
    }
    BatchPlan& batch = batches[open[point.group]];
    batch.insert(batch.end(), points.begin() + static_cast<std::ptrdiff_t>(i),
                 points.begin() + static_cast<std::ptrdiff_t>(i + builds));
  }
  return batches;
}

class GridRun {
public:
  GridRun(const Scenario& scenario, const std::vector<Point*>& chosen, const std::vector<Build>& builds,
          const TechniqueCatalogue& catalogue, const RunnerOptions& options, Progress& progress)
      : m_builds(builds), m_catalogue(catalogue), m_options(options), m_progress(progress), m_devices(options.device),
        m_experiment(options.resultsFolder, scenario) {
    m_result.folder = m_experiment.folder();
    plan(chosen);
  }

  RunnerResult run() {
    m_progress.start(m_planned);
    for (auto& runs : m_plan) {
      if (interruptRequested) break;
      work(std::move(runs));
    }
    settleElsewhere();
    m_progress.finish();
    if (m_options.writeIndex) m_experiment.writeIndex();
    m_result.interrupted = interruptRequested;
    return m_result;
  }

private:
  void plan(const std::vector<Point*>& chosen) {
    int replicates = 0;
    for (const Point* point : chosen)
      replicates = std::max(replicates, point->settings.measure.replicates);
    const auto batches = batchesOf(chosen, m_builds.size());
    std::set<std::string> seen;
    for (int replicate = 0; replicate < replicates; ++replicate)
      for (const auto& batch : batches)
        planBatch(batch, replicate, seen);
  }

  void planBatch(const BatchPlan& batch, int replicate, std::set<std::string>& seen) {
    std::vector<PendingRun> pending;
    for (const Point* point : batch) {
      if (replicate >= point->settings.measure.replicates) continue;
      const Build& build = m_builds[static_cast<std::size_t>(point->index) % m_builds.size()];
      CatalogueEntry technique = m_catalogue.get(point->settings.technique);
      const auto digests = build.digestsOf(point->settings.technique).value_or(Build::TechniqueDigests{});
      technique.moduleDigest = digests.module;
      // The name too: the same program under two names is two runs, which is how noise is measured.
      const std::string digest = build.name().empty() ? digests.build : digests.build + "/" + build.name();
      const std::string& device = m_devices.of(technique.factory->info);
      const RunIdentity identity{point->hash, runHash(point->hash, digest, device, replicate), replicate};
      if (!seen.insert(identity.run).second) continue; // two points of equal content are one run
      if (isDone(identity))
        ++m_result.alreadyDone;
      else
        pending.push_back({point, &build, technique, identity});
    }
    if (replicate % 2 == 1) std::reverse(pending.begin(), pending.end());
    m_planned += static_cast<int>(pending.size());
    if (!pending.empty()) m_plan.push_back(std::move(pending));
  }

  bool isDone(const RunIdentity& identity) const {
    const auto status = m_experiment.statusOf(identity);
    if (!status) return false;
    m_experiment.releaseStaleClaim(identity);
    return *status == nameOf(RunStatus::completed) || !m_options.retryFailed;
  }

  void work(std::vector<PendingRun> runs) {
    const auto size = static_cast<double>(runs.size());
    const double before = m_done;
    const auto done = [this](const RunIdentity& identity) { return isDone(identity); };
    Batch batch(m_experiment, m_options, m_pool, done, std::move(runs));
    batch.work([&](double share, const std::string& what) { m_progress.advanceTo(before + share * size, what); });
    m_result.alreadyDone += batch.doneMeanwhile();
    if (!batch.elsewhere().empty()) m_elsewhere.push_back(batch.elsewhere());
    for (const Batch::Ended& ended : batch.ended())
      count(ended);
    // Memory is short: whole processes alternate, and replicates turn the order around.
    m_done = before + size - static_cast<double>(batch.deferred().size());
    for (const PendingRun& run : batch.deferred())
      if (!interruptRequested) work({run});
  }

  /// What other processes had claimed: done meanwhile, or taken over if they turn out to be gone, or left to them.
  void settleElsewhere() {
    bool first = true;
    while (!m_elsewhere.empty() && !interruptRequested) {
      if (!first && !m_experiment.watchesClaims()) break;
      if (!first) std::this_thread::sleep_for(std::chrono::seconds(1));
      first = false;
      for (auto& runs : std::exchange(m_elsewhere, {})) {
        std::erase_if(runs, [this](const PendingRun& run) { return isDone(run.identity); });
        m_done -= static_cast<double>(runs.size());
        work(std::move(runs));
      }
      m_progress.advanceTo(m_done, "watching whether other machines that have claimed runs are alive");
    }
    for (const auto& runs : m_elsewhere)
      m_result.elsewhere += static_cast<int>(runs.size());
  }

  void count(const Batch::Ended& ended) {
    if (ended.status == nameOf(RunStatus::completed))
      ++m_result.completed;
    else if (ended.status == nameOf(RunStatus::unsupported))
      ++m_result.unsupported;
    else
      ++m_result.failed;
    m_progress.say(summaryOf(m_experiment, ended.run->identity));
  }

  const std::vector<Build>& m_builds;
  const TechniqueCatalogue& m_catalogue;
  const RunnerOptions& m_options;
  Progress& m_progress;
  DeviceIdentities m_devices;
  Experiment m_experiment;
  WorkerPool m_pool;
  RunnerResult m_result;
  std::vector<std::vector<PendingRun>> m_plan;
  std::vector<std::vector<PendingRun>> m_elsewhere;
  int m_planned = 0;
  double m_done = 0;
};

} // namespace

RunnerResult runScenario(Scenario scenario, const TechniqueCatalogue& catalogue, const RunnerOptions& options,
                         Progress& progress) {
  const std::vector<Build> builds = openBuilds(catalogue, options.builds);
  addBuildAxis(scenario, builds);
  const std::vector<Point*> chosen = chosenPoints(scenario, options, builds.size());
  identifyPoints(chosen, options);
  return GridRun(scenario, chosen, builds, catalogue, options, progress).run();
}

} // namespace volmark
