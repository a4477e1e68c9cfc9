#include "gpu/upload_arena.h"

#include <algorithm>
#include <cassert>

namespace volmark::gpu {

UploadArena::UploadArena(Device& device, VkBufferUsageFlags usage) : m_device(device), m_usage(usage) {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(device.physical(), &properties);
  m_alignment =
      std::max({properties.limits.minUniformBufferOffsetAlignment, properties.limits.minStorageBufferOffsetAlignment,
                properties.limits.optimalBufferCopyOffsetAlignment, VkDeviceSize(16)});
}

StagedBytes UploadArena::allocate(VkDeviceSize bytes) {
  assert(bytes > 0);
  const VkDeviceSize rounded = (bytes + m_alignment - 1) / m_alignment * m_alignment;
  while (m_current < m_blocks.size() && m_used + rounded > m_blocks[m_current].bytes()) {
    ++m_current;
    m_used = 0;
  }
  if (m_current == m_blocks.size())
    m_blocks.emplace_back(m_device,
                          BufferDescription{"", std::max(rounded, kBlockBytes), m_usage, MemoryAccess::upload});
  const Buffer& block = m_blocks[m_current];
  const VkDeviceSize offset = m_used;
  m_used += rounded;
  return {block.mapped().subspan(offset, bytes), {block.handle(), offset, bytes}};
}

void UploadArena::reset() {
  m_current = 0;
  m_used = 0;
}

void UploadArena::trim() {
  reset();
  std::erase_if(m_blocks, [](const Buffer& block) { return block.bytes() > kKeptBytes; });
}

} // namespace volmark::gpu
