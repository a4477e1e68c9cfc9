// Bytes of device memory by resource name: what a technique says it uses is checked against this.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace volmark::gpu {

struct MemoryItem {
  std::string name;
  std::uint64_t bytes = 0;
};

/// Thread-safe. Names need not be unique: bytes of equal names add up.
class MemoryLedger {
public:
  void add(const std::string& name, std::uint64_t bytes);
  void remove(const std::string& name, std::uint64_t bytes);

  std::vector<MemoryItem> items() const; ///< by name, without zero entries
  std::uint64_t totalBytes() const;
  std::uint64_t peakBytes() const; ///< largest total since construction or resetPeak()
  void resetPeak();

private:
  mutable std::mutex m_mutex;
  std::map<std::string, std::uint64_t> m_bytes;
  std::uint64_t m_total = 0;
  std::uint64_t m_peak = 0;
};

} // namespace volmark::gpu
