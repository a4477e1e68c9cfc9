#include "worker/worker_run.h"

#include "measure/clocks.h"
#include "results/experiment.h"
#include "results/provenance.h"
#include "volmark/gpu/stamp_self_test.h"
#include "worker/replay.h"
#include "worker/worker_pool.h"

#include <fmt/format.h>

#include <cmath>

namespace volmark {

namespace {

namespace fs = std::filesystem;

/// Replays of a technique that is not deterministic, to show their spread.
constexpr int kReplays = 3;

/// Attempts of the stamp self-test before breakdown orbits are given up.
constexpr int kStampTests = 5;

Point pointOf(const WorkerStart& start, const TechniqueCatalogue& catalogue) {
  Point point;
  point.settings = readPoint(start.settings, "point", catalogue, start.scenesFolder);
  point.config = start.config;
  for (const auto& [axis, value] : start.labels)
    point.labels.push_back({axis, value});
  point.hash = start.pointHash;
  point.group = start.group;
  point.index = start.pointIndex;
  return point;
}

std::vector<fs::path> pathsOf(const std::vector<std::string>& texts) {
  return {texts.begin(), texts.end()};
}

} // namespace

const TechniqueCatalogue& WorkerMemory::catalogue(const std::vector<std::string>& folders) {
  if (!m_catalogue || m_folders != folders) {
    m_catalogue.emplace(folders.empty() ? techniqueFolders() : pathsOf(folders));
    m_folders = folders;
  }
  return *m_catalogue;
}

std::shared_ptr<const Volume> WorkerMemory::volume(const Point& point, const DataFolders& data,
                                                   std::uint64_t maximumBytes) {
  if (!m_volume || m_volumeKey != volumeKeyOf(point)) {
    m_volume = nullptr; // before another takes its memory
    m_volume = openVolume(point.settings.scene, data, maximumBytes);
    m_volumeKey = volumeKeyOf(point);
  }
  return m_volume;
}

WorkerRun::WorkerRun(const WorkerStart& start, LineChannel& runner, WorkerMemory& kept)
    : m_start(start), m_runner(runner), m_kept(kept), m_point(pointOf(start, kept.catalogue(start.techniqueFolders))),
      m_entry(kept.catalogue(start.techniqueFolders).get(m_point.settings.technique)) {
}

void WorkerRun::take(const std::string& turn, const TurnRow& place) {
  m_turnBeginMs = monotonicMs();
  act(turn, place);
  m_activeMs += monotonicMs() - m_turnBeginMs;
}

nlohmann::json WorkerRun::provenanceNow() {
  return provenance(m_session && m_session->device() ? &m_session->device()->facts() : nullptr);
}

void WorkerRun::act(const std::string& turn, const TurnRow& place) {
  if (turn == "prepare")
    prepare();
  else if (turn == "warm_up")
    m_timed->warmUp();
  else if (turn == "headline")
    headline(place);
  else if (turn == "breakdown")
    breakdown(place);
  else
    finish();
}

void WorkerRun::tick() {
  ++m_frames;
  const double now = monotonicMs();
  if (now - m_lastTickMs < 500) return;
  m_lastTickMs = now;
  m_runner.send({{"frames", m_frames}});
}

void WorkerRun::prepare() {
  const DataFolders data{pathsOf(m_start.dataFolders)};
  auto volume = m_kept.volume(m_point, data, m_start.maximumBytes);
  m_record.provenance = nlohmann::json::object();
  m_session = std::make_unique<Session>(m_point.settings, m_entry, std::move(volume),
                                        SessionOptions{m_start.device, m_start.validate});
  const double beginMs = monotonicMs();
  const FrameTimes times = m_session->prepare();
  m_record.prepareMs = monotonicMs() - beginMs;
  for (const auto& pass : times.passes) {
    const double none = std::nan("");
    m_record.generation.push_back({pass.name, pass.onGpu ? none : pass.ms, pass.onGpu ? pass.ms : none});
  }
  m_timed = std::make_unique<TimedPass>(*m_session, [this] { tick(); });
}

void WorkerRun::headline(const TurnRow& place) {
  m_timed->orbit(OrbitKind::headline, place.orbit);
  m_record.turns.push_back(place);
}

/// Times of passes are taken only where stamps tell passes apart.
void WorkerRun::breakdown(TurnRow place) {
  keepTimedFrame();
  if (!m_stampsTrusted) testStamps();
  if (!*m_stampsTrusted) return;
  m_timed->orbit(OrbitKind::breakdown, place.orbit);
  place.orbitKind = OrbitKind::breakdown;
  m_record.turns.push_back(place);
}

void WorkerRun::testStamps() {
  m_stampsTrusted = true;
  gpu::Device* device = m_session->device();
  if (!device) return;
  // Another process may have got in the way of one attempt.
  gpu::StampSelfTest test = gpu::runStampSelfTest(*device);
  for (int i = 1; i < kStampTests && !test.trusted; ++i)
    test = gpu::runStampSelfTest(*device);
  m_stampsTrusted = test.trusted;
  m_record.checks.push_back({"stamps_tell_passes_apart", test.trusted, gpu::describe(test)});
}

/// Reads back the last headline frame, once, before anything else is drawn.
void WorkerRun::keepTimedFrame() {
  if (!m_timedFrame.empty()) return;
  m_timedFrame = m_session->pictures();
  m_trace = m_timed->trace();
}

void WorkerRun::finish() {
  keepTimedFrame();
  m_record.frames = m_timed->rows();
  m_record.firstFrameMs = m_timed->firstFrameMs();
  checkMemory();

  Replay replay(*m_session, m_trace, [this] { tick(); });
  std::vector<std::size_t> wanted = replay.capturedFrames(m_point.settings.pictures.count);
  auto captured = replay.draw(wanted);
  checkReplays(replay, captured.at(wanted.back()));
  m_record.counters = replay.count(captured);

  const Judgement judgement{*m_session, m_trace, m_start.stagingFolder, m_start.experimentFolder, m_start.runHash};
  m_record.pictures = judgePictures(judgement, captured, m_record.frames);
  m_record.provenance = provenanceNow();
  const std::uint64_t leaked = m_session->close();
  m_record.checks.push_back(
      {"memory_is_returned", leaked == 0, fmt::format("{} bytes in the ledger after the technique's end", leaked)});
  checkValidation();
  m_record.activeSeconds = (m_activeMs + monotonicMs() - m_turnBeginMs) / 1000;
  const Experiment experiment{fs::path(m_start.experimentFolder)};
  experiment.commit({m_start.pointHash, m_start.runHash, m_start.replicate}, m_point, m_entry, m_record);
}

void WorkerRun::checkReplays(Replay& replay, const std::vector<Picture>& first) {
  const std::size_t last = m_trace.phases.size() - 1;
  std::vector<std::vector<Picture>> replays{first};
  const bool deterministic = m_session->info().deterministic;
  for (int i = 1; !deterministic && i < kReplays; ++i)
    replays.push_back(replay.draw({last}).at(last));
  m_record.checks.push_back(compareTimedWithReplay(m_timedFrame, replays, deterministic));
  if (m_session->info().history == History::lossless)
    m_record.checks.push_back(compareWithFreshState(*m_session, m_trace, last, first));
}

/// What the technique says it uses against what the allocator saw.
void WorkerRun::checkMemory() {
  m_record.memory = m_session->technique().memory();
  std::uint64_t said = 0;
  for (const auto& item : m_record.memory)
    said += item.bytes;
  gpu::Device* device = m_session->device();
  if (!device) return;
  m_record.ledgerBytes = m_session->techniqueBytes();
  m_record.ledgerPeakBytes = device->ledger().peakBytes();
  m_record.checks.push_back({"memory_equals_ledger", said == m_record.ledgerBytes,
                             fmt::format("technique {} bytes, ledger {}", said, m_record.ledgerBytes)});
}

void WorkerRun::checkValidation() {
  if (!m_start.validate || !m_session->device()) return;
  const auto messages = m_session->device()->validationMessages();
  const std::string detail =
      messages.empty() ? "silent" : fmt::format("{} message(s), first: {}", messages.size(), messages.front());
  m_record.checks.push_back({"validation", messages.empty(), detail});
}

} // namespace volmark
