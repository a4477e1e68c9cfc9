#include "volmark/gpu/frame_recorder.h"

#include "sdk/pass_log.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <stdexcept>

namespace volmark::gpu {

namespace {

constexpr int kMaximumStamps = 1024;
constexpr int kHeadlineStamps = 3;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

} // namespace

FrameRecorder::FrameRecorder(Commands& commands, StampMode mode)
    : m_commands(commands), m_mode(mode), m_log(std::make_unique<PassLog>()) {
  const DeviceFacts& facts = commands.device().facts();
  if (facts.timestampValidBits == 0) return;
  m_mask = facts.timestampValidBits >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << facts.timestampValidBits) - 1;
  m_periodNs = facts.timestampPeriodNs;
  VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
  info.queryType = VK_QUERY_TYPE_TIMESTAMP;
  info.queryCount = kMaximumStamps;
  check(vkCreateQueryPool(commands.device().handle(), &info, nullptr, &m_pool), "vkCreateQueryPool");
}

FrameRecorder::~FrameRecorder() {
  if (!hasStamps()) return;
  try {
    m_commands.wait();
  } catch (const std::exception&) {
    return; // the GPU did not answer and may still write to the pool
  }
  vkDestroyQueryPool(m_commands.device().handle(), m_pool, nullptr);
}

int FrameRecorder::stamp() {
  if (!hasStamps()) return -1;
  assert(m_stampCount < kMaximumStamps);
  m_commands.barrier(kAnything, kAnything);
  vkCmdWriteTimestamp2(m_commands.handle(), VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, m_pool,
                       static_cast<std::uint32_t>(m_stampCount));
  m_commands.barrier(kAnything, kAnything);
  return m_stampCount++;
}

void FrameRecorder::beginFrame() {
  m_log->clear();
  m_stampCount = 0;
  m_updateStamp = -1;
  m_commands.begin();
  if (hasStamps())
    vkCmdResetQueryPool(m_commands.handle(), m_pool, 0,
                        m_mode == StampMode::headline ? kHeadlineStamps : kMaximumStamps);
  stamp();
}

void FrameRecorder::markUpdateDone() {
  assert(!m_log->isOpen());
  const auto& passes = m_log->passes();
  const bool recorded = std::any_of(passes.begin(), passes.end(), [](const LoggedPass& pass) { return pass.onGpu; });
  if (recorded) m_updateStamp = stamp();
  m_log->markUpdateDone();
}

void FrameRecorder::endFrame() {
  assert(!m_log->isOpen());
  stamp();
  m_commands.submit();
}

int FrameRecorder::beginGpuPass(std::string_view name) {
  // Room for both ends, the mark after update and the frame's last stamp: ends can't report an error.
  if (m_stampCount + 4 > kMaximumStamps) throw std::logic_error("more passes in one frame than there are stamps for");
  const int index = m_log->begin(name, true);
  if (m_mode == StampMode::breakdown) m_log->pass(index).firstStamp = stamp();
  return index;
}

int FrameRecorder::beginHostPass(std::string_view name) {
  return m_log->begin(name, false);
}

void FrameRecorder::endPass(int index) noexcept {
  LoggedPass& pass = m_log->pass(index);
  if (pass.onGpu && m_mode == StampMode::breakdown) pass.lastStamp = stamp();
  m_log->end(index);
}

double FrameRecorder::msBetween(int first, int last, const std::vector<std::uint64_t>& stamps) const {
  if (first < 0 || last < 0) return kNone;
  const std::uint64_t ticks =
      (stamps[static_cast<std::size_t>(last)] - stamps[static_cast<std::size_t>(first)]) & m_mask;
  return static_cast<double>(ticks) * m_periodNs * 1e-6;
}

FrameTimes FrameRecorder::finish() {
  m_commands.wait();
  std::vector<std::uint64_t> stamps(static_cast<std::size_t>(m_stampCount));
  if (m_stampCount > 0)
    check(vkGetQueryPoolResults(m_commands.device().handle(), m_pool, 0, static_cast<std::uint32_t>(m_stampCount),
                                stamps.size() * sizeof(std::uint64_t), stamps.data(), sizeof(std::uint64_t),
                                VK_QUERY_RESULT_64_BIT),
          "vkGetQueryPoolResults");
  return timesOf(stamps);
}

FrameTimes FrameRecorder::timesOf(const std::vector<std::uint64_t>& stamps) const {
  FrameTimes times;
  const int last = m_stampCount - 1;
  const int split = m_updateStamp >= 0 ? m_updateStamp : std::min(0, last);
  times.gpuMs = msBetween(std::min(0, last), last, stamps);
  times.updateGpuMs = msBetween(std::min(0, last), split, stamps);
  times.drawGpuMs = msBetween(split, last, stamps);
  for (const LoggedPass& pass : m_log->passes()) {
    const double hostMs = pass.endMs - pass.beginMs;
    if (!pass.onGpu) (pass.inUpdate ? times.updateHostMs : times.drawHostMs) += hostMs;
    if (pass.onGpu && m_mode == StampMode::headline) continue;
    addPassTime(times, {pass.name, pass.onGpu, pass.onGpu ? msBetween(pass.firstStamp, pass.lastStamp, stamps) : hostMs,
                        hostMs});
  }
  return times;
}

} // namespace volmark::gpu
