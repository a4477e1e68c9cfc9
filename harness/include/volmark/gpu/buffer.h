// A buffer and its memory.
#pragma once

#include "volmark/gpu/device.h"

#include <cstddef>
#include <span>
#include <string>

namespace volmark::gpu {

enum class MemoryAccess {
  device,   ///< device-local, not mapped
  upload,   ///< host-visible and coherent, mapped: the host writes, the device reads
  readback, ///< host-visible, cached where possible, coherent, mapped: the device writes, the host reads
};

struct BufferDescription {
  std::string name;             ///< ledger and debug name; empty: the harness's own, not in the ledger
  VkDeviceSize bytes = 0;       ///< > 0
  VkBufferUsageFlags usage = 0; ///< shader device address is added where asked for by usage
  MemoryAccess access = MemoryAccess::device;
};

/// A part of a buffer, for binding.
struct BufferRange {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset = 0;
  VkDeviceSize bytes = VK_WHOLE_SIZE;
};

/// Move-only owner. Throws UnsupportedError when memory is short or the size is over the device's limit.
class Buffer {
public:
  Buffer() = default;
  Buffer(Device& device, const BufferDescription& description);
  ~Buffer();
  Buffer(Buffer&& other) noexcept;
  Buffer& operator=(Buffer&& other) noexcept;

  VkBuffer handle() const { return m_handle; }
  VkDeviceSize bytes() const { return m_bytes; }
  VkDeviceAddress address() const;                            ///< needs SHADER_DEVICE_ADDRESS usage
  std::span<std::byte> mapped() const;                        ///< empty for MemoryAccess::device
  BufferRange range() const;                                  ///< all of it
  MemoryItem memory() const { return {m_name, m_allocated}; } ///< what it added to the ledger
  explicit operator bool() const { return m_handle != VK_NULL_HANDLE; }

private:
  void destroy() noexcept;

  Device* m_device = nullptr;
  std::string m_name;
  VkBuffer m_handle = VK_NULL_HANDLE;
  VkDeviceMemory m_memory = VK_NULL_HANDLE;
  VkDeviceSize m_bytes = 0;
  VkDeviceSize m_allocated = 0;
  void* m_mapped = nullptr;
};

} // namespace volmark::gpu
