// Host-visible memory handed out piece by piece and taken back all at once.
#pragma once

#include "volmark/gpu/buffer.h"

#include <cstddef>
#include <span>
#include <vector>

namespace volmark::gpu {

/// A mapped piece of memory and where the device finds it.
struct StagedBytes {
  std::span<std::byte> host;
  BufferRange range;
};

/// Not in the ledger: it is the harness's memory, not the technique's.
class UploadArena {
public:
  UploadArena(Device& device, VkBufferUsageFlags usage);

  /// Uninitialised memory that stays valid until reset(). `bytes` > 0.
  StagedBytes allocate(VkDeviceSize bytes);
  /// Everything is free again; the memory is kept.
  void reset();
  /// reset(), and blocks over kKeptBytes are given back.
  void trim();

private:
  static constexpr VkDeviceSize kBlockBytes = 1 << 20;
  static constexpr VkDeviceSize kKeptBytes = 4 << 20;

  Device& m_device;
  VkBufferUsageFlags m_usage;
  VkDeviceSize m_alignment;
  std::vector<Buffer> m_blocks;
  std::size_t m_current = 0; ///< block being filled
  VkDeviceSize m_used = 0;   ///< of that block
};

} // namespace volmark::gpu
