#include "worker/runner.h"

#include "results/provenance.h"
#include "timeline/timeline.h"
#include "volmark/error.h"
#include "worker/batch.h"
#include "worker/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace volmark {

std::atomic<bool> interruptRequested{false};

namespace {

void refuseOverLimit(const PointSettings& settings, const Volume& volume) {
  const auto voxels = static_cast<std::int64_t>(volume.grid().voxelCount());
  if (settings.maximumVoxels && voxels > *settings.maximumVoxels)
    throw InputError(fmt::format("scene \"{}\": found {} voxels, allowed: {} (limits.voxels of the profile)",
                                 settings.scene.name, voxels, *settings.maximumVoxels));
}

/// Loads each distinct volume once: bad data stops here, and the identities name the points.
void identifyPoints(Scenario& scenario, const RunnerOptions& options) {
  std::map<std::string, std::vector<Point*>> byVolume;
  for (Point& point : scenario.points) {
    const SceneDescription& scene = point.settings.scene;
    byVolume[scene.path.string() + point.config.value("volume", nlohmann::json()).dump()].push_back(&point);
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

/// Points that are interleaved, in the scenario's order; split where too many would live at once.
std::vector<std::vector<const Point*>> batchesOf(const Scenario& scenario) {
  std::vector<std::vector<const Point*>> batches;
  std::map<std::string, std::size_t> open; // group -> batch that still has room
  for (const Point& point : scenario.points) {
    const auto found = open.find(point.group);
    const auto room = static_cast<std::size_t>(point.settings.measure.interleave);
    if (found != open.end() && batches[found->second].size() < room) {
      batches[found->second].push_back(&point);
      continue;
    }
    open[point.group] = batches.size();
    batches.push_back({&point});
  }
  return batches;
}

class GridRun {
public:
  GridRun(const Scenario& scenario, const TechniqueCatalogue& catalogue, const RunnerOptions& options,
          Progress& progress)
      : m_catalogue(catalogue), m_options(options), m_progress(progress), m_devices(options.device),
        m_experiment(options.resultsFolder, scenario) {
    m_result.folder = m_experiment.folder();
    plan(scenario);
  }

  RunnerResult run() {
    m_progress.start(m_planned);
    for (auto& runs : m_plan) {
      if (interruptRequested) break;
      work(std::move(runs));
    }
    m_progress.finish();
    m_experiment.writeIndex();
    m_result.interrupted = interruptRequested;
    return m_result;
  }

private:
  void plan(const Scenario& scenario) {
    int replicates = 0;
    for (const Point& point : scenario.points)
      replicates = std::max(replicates, point.settings.measure.replicates);
    const auto batches = batchesOf(scenario);
    std::set<std::string> seen;
    for (int replicate = 0; replicate < replicates; ++replicate)
      for (const auto& batch : batches)
        planBatch(batch, replicate, seen);
  }

  void planBatch(const std::vector<const Point*>& batch, int replicate, std::set<std::string>& seen) {
    std::vector<PendingRun> pending;
    for (const Point* point : batch) {
      if (replicate >= point->settings.measure.replicates) continue;
      const CatalogueEntry& technique = m_catalogue.get(point->settings.technique);
      const std::string& device = m_devices.of(technique.factory->info);
      const RunIdentity identity{
          point->hash, runHash(point->hash, buildDigest(technique.moduleDigest), device, replicate), replicate};
      if (!seen.insert(identity.run).second) continue; // two points of equal content are one run
      if (isDone(identity))
        ++m_result.alreadyDone;
      else
        pending.push_back({point, &technique, identity});
    }
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
    Batch batch(m_experiment, m_options, std::move(runs));
    batch.work([&](double share, const std::string& what) { m_progress.advanceTo(before + share * size, what); });
    m_result.elsewhere += batch.elsewhere();
    for (const Batch::Ended& ended : batch.ended())
      count(ended);
    m_done = before + size;
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

  const TechniqueCatalogue& m_catalogue;
  const RunnerOptions& m_options;
  Progress& m_progress;
  DeviceIdentities m_devices;
  Experiment m_experiment;
  RunnerResult m_result;
  std::vector<std::vector<PendingRun>> m_plan;
  int m_planned = 0;
  double m_done = 0;
};

} // namespace

RunnerResult runScenario(Scenario scenario, const TechniqueCatalogue& catalogue, const RunnerOptions& options,
                         Progress& progress) {
  identifyPoints(scenario, options);
  return GridRun(scenario, catalogue, options, progress).run();
}

} // namespace volmark
