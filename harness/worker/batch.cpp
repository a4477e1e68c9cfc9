#include "worker/batch.h"

#include "measure/clocks.h"
#include "results/provenance.h"
#include "scenario/point_keys.h"
#include "volmark/random.h"

#include <fmt/format.h>

#include <algorithm>

namespace volmark {

struct Batch::Member {
  PendingRun run;
  std::unique_ptr<Claim> claim;
  std::unique_ptr<WorkerLink> link;
  double activeMs = 0; ///< in granted turns: what the time limit is about
  bool alive = true;
};

namespace {

/// Beside what the largest worker took so far: others may grow later, in their reference pictures for one.
constexpr std::uint64_t kSpareBytes = 256ull << 20;

/// How often a waiting runner looks at signals, time limits and heartbeats.
constexpr int kPollMs = 500;

WorkerStart startOf(const PendingRun& run, const RunnerOptions& options, const Experiment& experiment,
                    const std::filesystem::path& staging) {
  WorkerStart start;
  start.config = run.point->config;
  start.settings = withoutDefaults(run.point->config);
  if (run.build->name().empty())
    for (const auto& folder : options.techniqueFolders)
      start.techniqueFolders.push_back(folder.string());
  start.scenesFolder = options.scenesFolder.string();
  for (const auto& folder : options.data.folders)
    start.dataFolders.push_back(folder.string());
  start.device = options.device;
  start.validate = options.validate;
  start.maximumBytes = options.maximumBytes;
  start.stagingFolder = staging.string();
  start.experimentFolder = experiment.folder().string();
  start.pointHash = run.identity.point;
  start.runHash = run.identity.run;
  start.replicate = run.identity.replicate;
  start.pointIndex = run.point->index;
  start.group = run.point->group;
  for (const Label& label : run.point->labels)
    start.labels.emplace_back(label.axis, label.value);
  return start;
}

} // namespace

Batch::Batch(const Experiment& experiment, const RunnerOptions& options, WorkerPool& pool,
             const std::function<bool(const RunIdentity&)>& isDone, std::vector<PendingRun> runs)
    : m_experiment(experiment), m_options(options), m_pool(pool) {
  for (PendingRun& run : runs) {
    auto claim = experiment.claim(run.identity);
    if (!claim) {
      m_elsewhere.push_back(run);
      continue;
    }
    if (isDone(run.identity)) {
      ++m_doneMeanwhile;
      continue;
    }
    auto member = std::make_unique<Member>();
    member->run = run;
    member->claim = std::move(claim);
    m_members.push_back(std::move(member));
  }
}

Batch::~Batch() = default;

std::vector<Batch::Member*> Batch::living() {
  std::vector<Member*> result;
  for (auto& member : m_members)
    if (member->alive) result.push_back(member.get());
  return result;
}

void Batch::work(const std::function<void(double, const std::string&)>& advance) {
  if (m_members.empty()) return;
  m_advance = advance;
  const PointSettings& settings = m_members.front()->run.point->settings;
  const bool timed = settings.pacing.mode == PacingSettings::Mode::timed;
  const int orbits = timed ? 1 : settings.pacing.orbits;
  const int breakdowns = settings.measure.breakdownOrbits;
  m_turnsPlanned = double(m_members.size()) * (3 + orbits + breakdowns);

  for (Member* member : living()) {
    if (hasRoomForAnother()) {
      begin(*member);
    } else {
      m_deferred.push_back(member->run);
      member->claim.reset();
      member->alive = false;
    }
  }
  everyoneTakes("warm_up", 0, false);
  for (int orbit = 0; orbit < orbits; ++orbit)
    everyoneTakes("headline", orbit, true);
  for (int orbit = 0; orbit < breakdowns; ++orbit)
    everyoneTakes("breakdown", orbit, true);
  for (Member* member : living()) {
    if (take(*member, "finish")) {
      m_ended.push_back({&member->run, nameOf(RunStatus::completed), ""});
      if (settings.measure.isolation == MeasureSettings::Isolation::volume)
        m_pool.giveBack(std::move(member->link), member->run.build->program(), volumeKeyOf(*member->run.point));
    } else if (member->alive) {
      abandon(*member);
    }
  }
}

bool Batch::hasRoomForAnother() {
  std::uint64_t used = 0;
  std::uint64_t largest = 0;
  for (const auto& member : m_members) {
    if (!member->alive || !member->link) continue;
    const std::uint64_t bytes = member->link->privateBytes();
    used += bytes;
    largest = std::max(largest, bytes);
  }
  if (largest == 0) return true; // the first has to try
  const std::uint64_t needed = largest + largest / 4 + kSpareBytes;
  if (m_options.workerBytes) return used + needed <= *m_options.workerBytes;
  const nlohmann::json available = hostFacts()["memory_available_bytes"];
  return !available.is_number() || needed <= available.get<std::uint64_t>();
}

void Batch::begin(Member& member) {
  const Build& build = *member.run.build;
  const std::string& technique = member.run.point->settings.technique;
  if (!build.digestsOf(technique)) {
    end(member, RunStatus::unsupported, fmt::format("build \"{}\" has no technique \"{}\"", build.name(), technique),
        {});
    return;
  }
  const auto staging = m_experiment.stage(member.run.identity);
  member.link = m_pool.take(build.program(), volumeKeyOf(*member.run.point));
  member.link->start(startOf(member.run, m_options, m_experiment, staging));
  take(member, "prepare");
}

void Batch::everyoneTakes(const std::string& turn, int orbit, bool shuffled) {
  std::vector<Member*> members = living();
  if (shuffled) {
    // Fisher-Yates with a recorded seed: the same experiment takes the same turns.
    const auto seed = static_cast<std::uint32_t>(m_members.front()->run.point->settings.measure.seed);
    const auto replicate = static_cast<std::uint32_t>(m_members.front()->run.identity.replicate);
    for (std::size_t i = members.size(); i > 1; --i) {
      const std::uint32_t bits = randomBits(seed, replicate, static_cast<std::uint32_t>(m_shuffles++), 0);
      std::swap(members[i - 1], members[bits % i]);
    }
  }
  for (std::size_t i = 0; i < members.size(); ++i)
    take(*members[i], turn, {OrbitKind::headline, orbit, static_cast<int>(i), static_cast<int>(members.size())});
}

bool Batch::take(Member& member, const std::string& turn, const TurnRow& place) {
  if (!member.alive || interruptRequested) return false;
  const PointSettings& settings = member.run.point->settings;
  member.link->grant(turn, place);
  const double beginMs = monotonicMs();
  for (;;) {
    const WorkerLink::Answer answer = member.link->wait(kPollMs);
    const double activeMs = member.activeMs + monotonicMs() - beginMs;
    for (const auto& other : m_members)
      if (other->claim) other->claim->beat();
    m_advance(std::min(1.0, m_turnsTaken / m_turnsPlanned), fmt::format("{}, {}", settings.technique, turn));

    using Kind = WorkerLink::Answer::Kind;
    if (answer.kind == Kind::done) {
      member.activeMs = activeMs;
      ++m_turnsTaken;
      return true;
    }
    if (interruptRequested) return false;
    if (answer.kind == Kind::failed || answer.kind == Kind::died) member.activeMs = activeMs;
    if (answer.kind == Kind::failed) {
      end(member, runStatusFromName(answer.message["failed"]), answer.message["reason"], answer.message["provenance"]);
      return false;
    }
    if (answer.kind == Kind::died) {
      end(member, RunStatus::crashed, fmt::format("the worker died in {}: {}", turn, answer.reason), {});
      return false;
    }
    const double limitGib = settings.measure.memoryLimitGib;
    const double usedGib = static_cast<double>(member.link->privateBytes()) / (1024.0 * 1024 * 1024);
    if (limitGib > 0 && usedGib > limitGib) {
      member.link->kill();
      member.activeMs = activeMs;
      end(member, RunStatus::outOfMemory,
          fmt::format("over the memory limit of {} GiB in {}: {:.2f} GiB (measure.memory_limit_gib)", limitGib, turn,
                      usedGib),
          {});
      return false;
    }
    if (activeMs > 1000 * settings.measure.timeLimitSeconds) {
      member.link->kill();
      member.activeMs = activeMs;
      end(member, RunStatus::timedOut,
          fmt::format("over the time limit of {} s in {} (measure.time_limit_seconds)",
                      settings.measure.timeLimitSeconds, turn),
          {});
      return false;
    }
  }
}

void Batch::abandon(Member& member) {
  member.link.reset();
  m_experiment.discard(member.run.identity);
}

void Batch::end(Member& member, RunStatus status, const std::string& reason, const nlohmann::json& known) {
  member.alive = false;
  member.link.reset();
  RunRecord record;
  record.status = status;
  record.reason = reason;
  record.activeSeconds = member.activeMs / 1000;
  record.provenance = known.is_object() ? known : provenance(nullptr);
  m_experiment.commit(member.run.identity, *member.run.point, member.run.technique, record);
  m_ended.push_back({&member.run, nameOf(status), reason});
}

} // namespace volmark
