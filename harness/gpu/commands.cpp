#include "volmark/gpu/commands.h"

#include "gpu/upload_arena.h"
#include "volmark/error.h"

#include <fmt/format.h>

#include <cassert>
#include <cstring>

namespace volmark::gpu {

struct Commands::Implementation {
  explicit Implementation(Device& device)
      : constants(device, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT),
        staging(device, VK_BUFFER_USAGE_TRANSFER_SRC_BIT) {}

  VkCommandPool pool = VK_NULL_HANDLE;
  VkCommandBuffer buffer = VK_NULL_HANDLE;
  VkFence fence = VK_NULL_HANDLE;
  UploadArena constants; ///< lives until the frame has finished
  UploadArena staging;   ///< lives until the submission that copies from it has finished
  bool recording = false;
  bool pending = false;    ///< submitted, not yet waited for
  bool unanswered = false; ///< the GPU did not answer: nothing of this may be destroyed

  void beginBuffer(VkDevice device);
};

void Commands::Implementation::beginBuffer(VkDevice device) {
  check(vkResetCommandPool(device, pool, 0), "vkResetCommandPool");
  VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(buffer, &info), "vkBeginCommandBuffer");
  recording = true;
}

Commands::Commands(Device& device) : m_device(device), m_implementation(std::make_unique<Implementation>(device)) {
  VkCommandPoolCreateInfo poolInfo{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  poolInfo.queueFamilyIndex = device.queueFamily();
  check(vkCreateCommandPool(device.handle(), &poolInfo, nullptr, &m_implementation->pool), "vkCreateCommandPool");
  VkCommandBufferAllocateInfo bufferInfo{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  bufferInfo.commandPool = m_implementation->pool;
  bufferInfo.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  bufferInfo.commandBufferCount = 1;
  check(vkAllocateCommandBuffers(device.handle(), &bufferInfo, &m_implementation->buffer), "vkAllocateCommandBuffers");
  const VkFenceCreateInfo fenceInfo{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  check(vkCreateFence(device.handle(), &fenceInfo, nullptr, &m_implementation->fence), "vkCreateFence");
}

Commands::~Commands() {
  try {
    wait();
  } catch (const std::exception&) {
    // Reported by the wait that failed first; a lost device's objects may be destroyed.
  }
  if (m_implementation->unanswered) {
    // The GPU may still write to what the arenas hold: leak rather than free it.
    [[maybe_unused]] const Implementation* leaked = m_implementation.release();
    return;
  }
  vkDestroyFence(m_device.handle(), m_implementation->fence, nullptr);
  vkDestroyCommandPool(m_device.handle(), m_implementation->pool, nullptr);
}

VkCommandBuffer Commands::handle() const {
  return m_implementation->buffer;
}

BufferRange Commands::constants(std::span<const std::byte> bytes) {
  const StagedBytes staged = m_implementation->constants.allocate(bytes.size());
  std::memcpy(staged.host.data(), bytes.data(), bytes.size());
  return staged.range;
}

void Commands::dispatch(const Pipeline& pipeline, std::span<const Resource> resources, std::span<const std::byte> push,
                        glm::uvec3 groups) {
  bind(pipeline, resources, push);
  vkCmdDispatch(handle(), groups.x, groups.y, groups.z);
}

void Commands::dispatchIndirect(const Pipeline& pipeline, std::span<const Resource> resources,
                                std::span<const std::byte> push, const BufferRange& arguments) {
  bind(pipeline, resources, push);
  vkCmdDispatchIndirect(handle(), arguments.buffer, arguments.offset);
}

void Commands::upload(const Buffer& destination, VkDeviceSize offset, std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  assert(offset + bytes.size() <= destination.bytes());
  const StagedBytes staged = m_implementation->staging.allocate(bytes.size());
  std::memcpy(staged.host.data(), bytes.data(), bytes.size());
  const VkBufferCopy region{staged.range.offset, offset, bytes.size()};
  vkCmdCopyBuffer(handle(), staged.range.buffer, destination.handle(), 1, &region);
}

void Commands::upload(const Image& destination, std::span<const std::byte> bytes) {
  const VkExtent3D& extent = destination.description().extent;
  transition(destination, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, kAnything, kTransferWrite);
  uploadSlab(destination, 0, extent.depth, bytes);
  transition(destination, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
             kTransferWrite, {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_SHADER_READ_BIT});
}

void Commands::uploadSlab(const Image& destination, std::uint32_t first, std::uint32_t count,
                          std::span<const std::byte> bytes) {
  const ImageDescription& description = destination.description();
  const StagedBytes staged = m_implementation->staging.allocate(bytes.size());
  std::memcpy(staged.host.data(), bytes.data(), bytes.size());
  VkBufferImageCopy region{};
  region.bufferOffset = staged.range.offset;
  region.imageSubresource = {destination.aspect(), 0, 0, description.layers};
  region.imageOffset.z = static_cast<std::int32_t>(first);
  region.imageExtent = {description.extent.width, description.extent.height, count};
  vkCmdCopyBufferToImage(handle(), staged.range.buffer, destination.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                         &region);
}

void Commands::fill(const Buffer& destination, std::uint32_t word) {
  vkCmdFillBuffer(handle(), destination.handle(), 0, VK_WHOLE_SIZE, word);
}

void Commands::barrier(const Use& before, const Use& after) {
  const VkMemoryBarrier2 memory{
      VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, nullptr, before.stages, before.access, after.stages, after.access};
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &memory;
  vkCmdPipelineBarrier2(handle(), &info);
}

void Commands::transition(const Image& image, VkImageLayout from, VkImageLayout to, const Use& before,
                          const Use& after) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.srcStageMask = before.stages;
  barrier.srcAccessMask = before.access;
  barrier.dstStageMask = after.stages;
  barrier.dstAccessMask = after.access;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.handle();
  barrier.subresourceRange = {image.aspect(), 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(handle(), &info);
}

void Commands::submitAndWait() {
  submit();
  wait();
  m_implementation->staging.reset();
  m_implementation->beginBuffer(m_device.handle());
}

void Commands::begin() {
  wait();
  m_implementation->constants.reset();
  m_implementation->staging.reset();
  m_implementation->beginBuffer(m_device.handle());
}

void Commands::submit() {
  Implementation& my = *m_implementation;
  assert(my.recording && !my.pending);
  // What shaders and copies wrote is there for the host once the fence is signalled.
  barrier(kAnything, kHostRead);
  check(vkEndCommandBuffer(my.buffer), "vkEndCommandBuffer");
  my.recording = false;
  const VkCommandBufferSubmitInfo bufferInfo{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, nullptr, my.buffer, 0};
  VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &bufferInfo;
  check(vkResetFences(m_device.handle(), 1, &my.fence), "vkResetFences");
  check(vkQueueSubmit2(m_device.queue(), 1, &info, my.fence), "vkQueueSubmit2");
  my.pending = true;
}

void Commands::wait() {
  Implementation& my = *m_implementation;
  if (!my.pending || my.unanswered) return;
  // Short slices, so that a lost device is noticed soon even by drivers that only say so when asked again.
  constexpr std::chrono::nanoseconds slice = std::chrono::seconds(1);
  for (std::chrono::nanoseconds waited{0}; waited < kGpuTimeout; waited += slice) {
    const VkResult result = vkWaitForFences(m_device.handle(), 1, &my.fence, VK_TRUE, slice.count());
    if (result == VK_TIMEOUT) continue;
    my.pending = false;
    check(result, "waiting for the GPU");
    return;
  }
  my.unanswered = true;
  throw DeviceError(fmt::format("no answer from the GPU for {} s", kGpuTimeout.count()));
}

void Commands::clearUploads() {
  assert(!m_implementation->recording && !m_implementation->pending);
  m_implementation->constants.trim();
  m_implementation->staging.trim();
}

} // namespace volmark::gpu
