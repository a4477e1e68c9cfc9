#include "volmark/gpu/buffer.h"

#include "volmark/error.h"

#include <fmt/format.h>

#include <cassert>
#include <utility>

namespace volmark::gpu {

namespace {

std::uint32_t memoryTypeFor(const Device& device, std::uint32_t allowedBits, MemoryAccess access) {
  constexpr VkMemoryPropertyFlags mapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  switch (access) {
  case MemoryAccess::device: return device.memoryType(allowedBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  case MemoryAccess::upload: return device.memoryType(allowedBits, mapped);
  case MemoryAccess::readback: return device.memoryType(allowedBits, mapped, VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
  }
  return 0;
}

} // namespace

Buffer::Buffer(Device& device, const BufferDescription& description)
    : m_device(&device), m_name(description.name), m_bytes(description.bytes) {
  assert(m_bytes > 0 && "a buffer of no bytes");
  if (m_bytes > device.facts().maximumAllocationBytes)
    throw UnsupportedError(fmt::format("buffer \"{}\" has {} bytes, the device allows {}", m_name, m_bytes,
                                       device.facts().maximumAllocationBytes));
  try {
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = m_bytes;
    info.usage = description.usage;
    check(vkCreateBuffer(device.handle(), &info, nullptr, &m_handle), "vkCreateBuffer");
    device.setName(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<std::uint64_t>(m_handle), m_name);

    VkMemoryRequirements requirements;
    vkGetBufferMemoryRequirements(device.handle(), m_handle, &requirements);
    VkMemoryAllocateFlagsInfo flags{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO};
    if (description.usage & VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT)
      flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
    VkMemoryAllocateInfo allocation{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, &flags};
    allocation.allocationSize = requirements.size;
    allocation.memoryTypeIndex = memoryTypeFor(device, requirements.memoryTypeBits, description.access);
    check(vkAllocateMemory(device.handle(), &allocation, nullptr, &m_memory), "vkAllocateMemory");
    check(vkBindBufferMemory(device.handle(), m_handle, m_memory, 0), "vkBindBufferMemory");
    if (description.access != MemoryAccess::device)
      check(vkMapMemory(device.handle(), m_memory, 0, VK_WHOLE_SIZE, 0, &m_mapped), "vkMapMemory");
    m_allocated = requirements.size;
  } catch (const UnsupportedError& error) {
    destroy();
    throw UnsupportedError(fmt::format("buffer \"{}\" of {} bytes: {}", m_name, description.bytes, error.what()));
  } catch (...) {
    destroy();
    throw;
  }
  if (!m_name.empty()) device.ledger().add(m_name, m_allocated);
}

Buffer::~Buffer() {
  destroy();
}

Buffer::Buffer(Buffer&& other) noexcept {
  *this = std::move(other);
}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
  if (this == &other) return *this;
  destroy();
  m_device = std::exchange(other.m_device, nullptr);
  m_name = std::exchange(other.m_name, {});
  m_handle = std::exchange(other.m_handle, VK_NULL_HANDLE);
  m_memory = std::exchange(other.m_memory, VK_NULL_HANDLE);
  m_bytes = std::exchange(other.m_bytes, 0);
  m_allocated = std::exchange(other.m_allocated, 0);
  m_mapped = std::exchange(other.m_mapped, nullptr);
  return *this;
}

void Buffer::destroy() noexcept {
  if (!m_device) return;
  if (m_handle) vkDestroyBuffer(m_device->handle(), m_handle, nullptr);
  if (m_memory) vkFreeMemory(m_device->handle(), m_memory, nullptr);
  if (m_allocated > 0 && !m_name.empty()) m_device->ledger().remove(m_name, m_allocated);
  m_handle = VK_NULL_HANDLE;
  m_memory = VK_NULL_HANDLE;
  m_bytes = m_allocated = 0;
  m_mapped = nullptr;
  m_device = nullptr;
}

VkDeviceAddress Buffer::address() const {
  assert(m_handle);
  const VkBufferDeviceAddressInfo info{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, nullptr, m_handle};
  return vkGetBufferDeviceAddress(m_device->handle(), &info);
}

std::span<std::byte> Buffer::mapped() const {
  if (!m_mapped) return {};
  return {static_cast<std::byte*>(m_mapped), static_cast<std::size_t>(m_bytes)};
}

BufferRange Buffer::range() const {
  return {m_handle, 0, m_bytes};
}

} // namespace volmark::gpu
