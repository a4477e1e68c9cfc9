// Images, their memory and views; samplers.
#pragma once

#include "volmark/gpu/device.h"

#include <string>
#include <vector>

namespace volmark::gpu {

struct ImageDescription {
  std::string name; ///< ledger and debug name; empty: the harness's own, not in the ledger
  VkImageType type = VK_IMAGE_TYPE_2D;
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkExtent3D extent{1, 1, 1};
  std::uint32_t layers = 1;
  std::uint32_t mipLevels = 1;
  VkImageUsageFlags usage = 0;
  VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
};

/// Move-only owner of an optimal-tiling image with a view of everything (2-D images: as an array of all
/// layers), a view of each layer and a view of each mip level. Starts in
/// VK_IMAGE_LAYOUT_UNDEFINED. Throws UnsupportedError when the extent, the format or the memory is beyond the device.
class Image {
public:
  Image() = default;
  Image(Device& device, const ImageDescription& description);
  ~Image();
  Image(Image&& other) noexcept;
  Image& operator=(Image&& other) noexcept;

  VkImage handle() const { return m_handle; }
  VkImageView view() const { return m_view; }
  VkImageView layerView(std::uint32_t layer) const { return m_layerViews.at(layer); }
  /// One mip level, all layers; usable as a storage image.
  VkImageView levelView(std::uint32_t level) const { return m_levelViews.at(level); }
  VkImageAspectFlags aspect() const;
  const ImageDescription& description() const { return m_description; }
  MemoryItem memory() const { return {m_description.name, m_allocated}; } ///< what it added to the ledger
  explicit operator bool() const { return m_handle != VK_NULL_HANDLE; }

private:
  void allocate();
  void createViews();
  void destroy() noexcept;

  Device* m_device = nullptr;
  ImageDescription m_description;
  VkImage m_handle = VK_NULL_HANDLE;
  VkDeviceMemory m_memory = VK_NULL_HANDLE;
  VkImageView m_view = VK_NULL_HANDLE;
  std::vector<VkImageView> m_layerViews;
  std::vector<VkImageView> m_levelViews;
  VkDeviceSize m_allocated = 0;
};

/// Move-only owner; clamps to the edge.
class Sampler {
public:
  Sampler() = default;
  Sampler(Device& device, VkFilter filter);
  ~Sampler();
  Sampler(Sampler&& other) noexcept;
  Sampler& operator=(Sampler&& other) noexcept;

  VkSampler handle() const { return m_handle; }

private:
  Device* m_device = nullptr;
  VkSampler m_handle = VK_NULL_HANDLE;
};

} // namespace volmark::gpu
