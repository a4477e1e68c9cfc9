// Work counters that shaders add to in counting frames (shaders/volmark/counters.glsl).
#pragma once

#include "volmark/gpu/commands.h"

#include <cstdint>
#include <vector>

namespace volmark::gpu {

/// `count` 64-bit counters, each a pair of 32-bit words with carry, so that no 64-bit atomics are needed.
class CounterBuffer {
public:
  CounterBuffer() = default;
  CounterBuffer(Device& device, int count);

  BufferRange range() const { return m_buffer.range(); }
  MemoryItem memory() const { return m_buffer.memory(); }
  /// Records zeroing, visible to the compute and graphics shaders that follow.
  void clear(Commands& commands) const;
  /// Values after the frame has finished.
  std::vector<std::uint64_t> read() const;

private:
  Buffer m_buffer; ///< host-visible: small and read only in counting frames
  int m_count = 0;
};

} // namespace volmark::gpu
