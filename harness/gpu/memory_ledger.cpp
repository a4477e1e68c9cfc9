#include "volmark/gpu/memory_ledger.h"

#include <algorithm>
#include <cassert>

namespace volmark::gpu {

void MemoryLedger::add(const std::string& name, std::uint64_t bytes) {
  const std::lock_guard lock(m_mutex);
  m_bytes[name] += bytes;
  m_total += bytes;
  m_peak = std::max(m_peak, m_total);
}

void MemoryLedger::remove(const std::string& name, std::uint64_t bytes) {
  const std::lock_guard lock(m_mutex);
  const auto found = m_bytes.find(name);
  assert(found != m_bytes.end() && found->second >= bytes);
  found->second -= bytes;
  if (found->second == 0) m_bytes.erase(found);
  m_total -= bytes;
}

std::vector<MemoryItem> MemoryLedger::items() const {
  const std::lock_guard lock(m_mutex);
  std::vector<MemoryItem> result;
  for (const auto& [name, bytes] : m_bytes)
    if (bytes > 0) result.push_back({name, bytes});
  return result;
}

std::uint64_t MemoryLedger::totalBytes() const {
  const std::lock_guard lock(m_mutex);
  return m_total;
}

std::uint64_t MemoryLedger::peakBytes() const {
  const std::lock_guard lock(m_mutex);
  return m_peak;
}

void MemoryLedger::resetPeak() {
  const std::lock_guard lock(m_mutex);
  m_peak = m_total;
}

} // namespace volmark::gpu
