#include "volmark/gpu/counter_buffer.h"

#include <cassert>
#include <cstring>

namespace volmark::gpu {

CounterBuffer::CounterBuffer(Device& device, int count)
    : m_buffer(device, {"counters", static_cast<VkDeviceSize>(count) * sizeof(std::uint64_t),
                        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryAccess::readback}),
      m_count(count) {
  std::memset(m_buffer.mapped().data(), 0, m_buffer.mapped().size());
}

void CounterBuffer::clear(Commands& commands) const {
  constexpr Use shaders{VK_PIPELINE_STAGE_2_ALL_GRAPHICS_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                        VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT};
  commands.barrier(shaders, kTransferWrite);
  commands.fill(m_buffer, 0);
  commands.barrier(kTransferWrite, shaders);
}

std::vector<std::uint64_t> CounterBuffer::read() const {
  // Low word first: a little-endian 64-bit number.
  std::vector<std::uint64_t> values(static_cast<std::size_t>(m_count));
  std::memcpy(values.data(), m_buffer.mapped().data(), values.size() * sizeof(std::uint64_t));
  return values;
}

} // namespace volmark::gpu
