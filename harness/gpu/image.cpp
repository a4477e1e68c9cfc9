#include "volmark/gpu/image.h"

#include "volmark/error.h"

#include <fmt/format.h>

#include <cassert>
#include <utility>

namespace volmark::gpu {

namespace {

VkImageCreateInfo createInfo(const ImageDescription& description) {
  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = description.type;
  info.format = description.format;
  info.extent = description.extent;
  info.mipLevels = description.mipLevels;
  info.arrayLayers = description.layers;
  info.samples = description.samples;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = description.usage;
  info.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
  return info;
}

std::string sizeText(const ImageDescription& description) {
  const VkExtent3D& extent = description.extent;
  return fmt::format("image \"{}\" of {} x {} x {} texels, {} layers", description.name, extent.width, extent.height,
                     extent.depth, description.layers);
}

/// Throws UnsupportedError when the device can't make such an image.
void requireSupport(const Device& device, const ImageDescription& description) {
  VkImageFormatProperties limits;
  const VkResult result = vkGetPhysicalDeviceImageFormatProperties(
      device.physical(), description.format, description.type, VK_IMAGE_TILING_OPTIMAL, description.usage, 0, &limits);
  if (result == VK_ERROR_FORMAT_NOT_SUPPORTED)
    throw UnsupportedError(fmt::format("{}: the device does not support format {} for this use (flags {:#x})",
                                       sizeText(description), static_cast<int>(description.format), description.usage));
  check(result, "vkGetPhysicalDeviceImageFormatProperties");
  const VkExtent3D& extent = description.extent;
  const VkExtent3D& most = limits.maxExtent;
  if (extent.width > most.width || extent.height > most.height || extent.depth > most.depth ||
      description.layers > limits.maxArrayLayers || description.mipLevels > limits.maxMipLevels)
    throw UnsupportedError(fmt::format("{}: the device allows {} x {} x {} texels and {} layers", sizeText(description),
                                       most.width, most.height, most.depth, limits.maxArrayLayers));
  if (!(limits.sampleCounts & description.samples))
    throw UnsupportedError(fmt::format("{}: the device does not support {} samples a pixel", sizeText(description),
                                       static_cast<int>(description.samples)));
}

/// Asked before the image is made: drivers and validation need not like the question afterwards.
void requireSize(const Device& device, const ImageDescription& description, const VkImageCreateInfo& info) {
  const VkDeviceImageMemoryRequirements question{VK_STRUCTURE_TYPE_DEVICE_IMAGE_MEMORY_REQUIREMENTS, nullptr, &info};
  VkMemoryRequirements2 answer{VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2};
  vkGetDeviceImageMemoryRequirements(device.handle(), &question, &answer);
  const std::uint64_t most = device.facts().maximumAllocationBytes;
  if (answer.memoryRequirements.size > most)
    throw UnsupportedError(fmt::format("{}: {} bytes, the device allows {} at once", sizeText(description),
                                       answer.memoryRequirements.size, most));
}

VkImageViewType viewType(VkImageType type) {
  switch (type) {
  case VK_IMAGE_TYPE_1D: return VK_IMAGE_VIEW_TYPE_1D_ARRAY;
  case VK_IMAGE_TYPE_3D: return VK_IMAGE_VIEW_TYPE_3D;
  default: return VK_IMAGE_VIEW_TYPE_2D_ARRAY;
  }
}

VkImageViewType layerViewType(VkImageType type) {
  switch (type) {
  case VK_IMAGE_TYPE_1D: return VK_IMAGE_VIEW_TYPE_1D;
  case VK_IMAGE_TYPE_3D: return VK_IMAGE_VIEW_TYPE_3D;
  default: return VK_IMAGE_VIEW_TYPE_2D;
  }
}

bool canHaveView(VkImageUsageFlags usage) {
  return usage & ~VkImageUsageFlags(VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT);
}

} // namespace

Image::Image(Device& device, const ImageDescription& description) : m_device(&device), m_description(description) {
  try {
    requireSupport(device, description);
    const VkImageCreateInfo info = createInfo(description);
    requireSize(device, description, info);
    check(vkCreateImage(device.handle(), &info, nullptr, &m_handle), "vkCreateImage");
    device.setName(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<std::uint64_t>(m_handle), description.name);
    allocate();
    createViews();
  } catch (const std::exception&) {
    destroy();
    throw;
  }
}

void Image::allocate() {
  VkMemoryRequirements requirements;
  vkGetImageMemoryRequirements(m_device->handle(), m_handle, &requirements);
  VkMemoryAllocateInfo allocation{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  allocation.allocationSize = requirements.size;
  allocation.memoryTypeIndex =
      m_device->memoryType(requirements.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  try {
    check(vkAllocateMemory(m_device->handle(), &allocation, nullptr, &m_memory), "vkAllocateMemory");
    check(vkBindImageMemory(m_device->handle(), m_handle, m_memory, 0), "vkBindImageMemory");
  } catch (const UnsupportedError& error) {
    throw UnsupportedError(fmt::format("{}, {} bytes: {}", sizeText(m_description), requirements.size, error.what()));
  }
  m_allocated = requirements.size;
  if (!m_description.name.empty()) m_device->ledger().add(m_description.name, m_allocated);
}

void Image::createViews() {
  if (!canHaveView(m_description.usage)) return;
  VkImageViewCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  info.image = m_handle;
  info.viewType = viewType(m_description.type);
  info.format = m_description.format;
  info.subresourceRange = {aspect(), 0, m_description.mipLevels, 0, m_description.layers};
  check(vkCreateImageView(m_device->handle(), &info, nullptr, &m_view), "vkCreateImageView");
  info.viewType = layerViewType(m_description.type);
  for (std::uint32_t layer = 0; layer < m_description.layers; ++layer) {
    info.subresourceRange.baseArrayLayer = layer;
    info.subresourceRange.layerCount = 1;
    VkImageView view = VK_NULL_HANDLE;
    check(vkCreateImageView(m_device->handle(), &info, nullptr, &view), "vkCreateImageView");
    m_layerViews.push_back(view);
  }
  info.viewType = viewType(m_description.type);
  info.subresourceRange = {aspect(), 0, 1, 0, m_description.layers};
  for (std::uint32_t level = 0; level < m_description.mipLevels; ++level) {
    info.subresourceRange.baseMipLevel = level;
    VkImageView view = VK_NULL_HANDLE;
    check(vkCreateImageView(m_device->handle(), &info, nullptr, &view), "vkCreateImageView");
    m_levelViews.push_back(view);
  }
}

Image::~Image() {
  destroy();
}

Image::Image(Image&& other) noexcept {
  *this = std::move(other);
}

Image& Image::operator=(Image&& other) noexcept {
  if (this == &other) return *this;
  destroy();
  m_device = std::exchange(other.m_device, nullptr);
  m_description = std::exchange(other.m_description, {});
  m_handle = std::exchange(other.m_handle, VK_NULL_HANDLE);
  m_memory = std::exchange(other.m_memory, VK_NULL_HANDLE);
  m_view = std::exchange(other.m_view, VK_NULL_HANDLE);
  m_layerViews = std::exchange(other.m_layerViews, {});
  m_levelViews = std::exchange(other.m_levelViews, {});
  m_allocated = std::exchange(other.m_allocated, 0);
  return *this;
}

void Image::destroy() noexcept {
  if (!m_device) return;
  const VkDevice device = m_device->handle();
  for (const std::vector<VkImageView>* views : {&m_layerViews, &m_levelViews})
    for (const VkImageView view : *views)
      vkDestroyImageView(device, view, nullptr);
  if (m_view) vkDestroyImageView(device, m_view, nullptr);
  if (m_handle) vkDestroyImage(device, m_handle, nullptr);
  if (m_memory) vkFreeMemory(device, m_memory, nullptr);
  if (m_allocated > 0 && !m_description.name.empty()) m_device->ledger().remove(m_description.name, m_allocated);
  m_layerViews.clear();
  m_levelViews.clear();
  m_view = VK_NULL_HANDLE;
  m_handle = VK_NULL_HANDLE;
  m_memory = VK_NULL_HANDLE;
  m_allocated = 0;
  m_device = nullptr;
}

VkImageAspectFlags Image::aspect() const {
  switch (m_description.format) {
  case VK_FORMAT_D16_UNORM:
  case VK_FORMAT_X8_D24_UNORM_PACK32:
  case VK_FORMAT_D32_SFLOAT: return VK_IMAGE_ASPECT_DEPTH_BIT;
  default: return VK_IMAGE_ASPECT_COLOR_BIT;
  }
}

Sampler::Sampler(Device& device, VkFilter filter) : m_device(&device) {
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  info.magFilter = info.minFilter = filter;
  info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST;
  info.addressModeU = info.addressModeV = info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  info.maxLod = VK_LOD_CLAMP_NONE;
  check(vkCreateSampler(device.handle(), &info, nullptr, &m_handle), "vkCreateSampler");
}

Sampler::~Sampler() {
  if (m_handle) vkDestroySampler(m_device->handle(), m_handle, nullptr);
}

Sampler::Sampler(Sampler&& other) noexcept {
  *this = std::move(other);
}

Sampler& Sampler::operator=(Sampler&& other) noexcept {
  if (this == &other) return *this;
  if (m_handle) vkDestroySampler(m_device->handle(), m_handle, nullptr);
  m_device = std::exchange(other.m_device, nullptr);
  m_handle = std::exchange(other.m_handle, VK_NULL_HANDLE);
  return *this;
}

} // namespace volmark::gpu
