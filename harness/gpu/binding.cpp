// Binding a pipeline with all its resources by push descriptors.
#include "volmark/gpu/commands.h"

#include <fmt/format.h>

#include <array>
#include <stdexcept>
#include <variant>

namespace volmark::gpu {

namespace {

constexpr std::size_t kMaximumBindings = 32; // what every implementation of push descriptors holds

/// Descriptor writes and what they point to.
struct DescriptorWrites {
  std::array<VkWriteDescriptorSet, kMaximumBindings> writes;
  std::array<VkDescriptorBufferInfo, kMaximumBindings> buffers;
  std::array<VkDescriptorImageInfo, kMaximumBindings> images;
  std::array<VkWriteDescriptorSetAccelerationStructureKHR, kMaximumBindings> structures;
};

bool isBuffer(VkDescriptorType type) {
  return type == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER || type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

/// Fills slot i; false if the resource is of another kind than the layout says.
bool describe(DescriptorWrites& all, std::size_t i, VkDescriptorType type, const Resource& resource) {
  VkWriteDescriptorSet& write = all.writes[i];
  write = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
  write.dstBinding = static_cast<std::uint32_t>(i);
  write.descriptorCount = 1;
  write.descriptorType = type;
  if (const auto* range = std::get_if<BufferRange>(&resource)) {
    all.buffers[i] = {range->buffer, range->offset, range->bytes};
    write.pBufferInfo = &all.buffers[i];
    return isBuffer(type);
  }
  if (const auto* image = std::get_if<StorageImage>(&resource)) {
    all.images[i] = {VK_NULL_HANDLE, image->view, VK_IMAGE_LAYOUT_GENERAL};
    write.pImageInfo = &all.images[i];
    return type == VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
  }
  if (const auto* image = std::get_if<SampledImage>(&resource)) {
    all.images[i] = {image->sampler, image->view, image->layout};
    write.pImageInfo = &all.images[i];
    return type == VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER || type == VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
  }
  const auto& structure = std::get<AccelerationStructure>(resource);
  all.structures[i] = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR, nullptr, 1,
                       &structure.handle};
  write.pNext = &all.structures[i];
  return type == VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR;
}

} // namespace

void Commands::bind(const Pipeline& pipeline, std::span<const Resource> resources, std::span<const std::byte> push) {
  // Our own bugs, but of a technique's author and cheap to see: told in every build.
  const PipelineLayoutDescription& layout = pipeline.layoutDescription();
  if (resources.size() != layout.bindings.size() || resources.size() > kMaximumBindings)
    throw std::logic_error(fmt::format("{}: {} resources for {} bindings (at most {})", pipeline.name(),
                                       resources.size(), layout.bindings.size(), kMaximumBindings));
  if (push.size() != layout.pushConstantBytes)
    throw std::logic_error(
        fmt::format("{}: {} bytes of push constants for {}", pipeline.name(), push.size(), layout.pushConstantBytes));
  DescriptorWrites all;
  for (std::size_t i = 0; i < resources.size(); ++i)
    if (!describe(all, i, layout.bindings[i], resources[i]))
      throw std::logic_error(fmt::format("{}: binding {} has a resource of another kind", pipeline.name(), i));

  vkCmdBindPipeline(handle(), pipeline.bindPoint(), pipeline.handle());
  if (!resources.empty())
    m_device.cmdPushDescriptorSet(handle(), pipeline.bindPoint(), pipeline.layout(), 0,
                                  static_cast<std::uint32_t>(resources.size()), all.writes.data());
  if (!push.empty())
    vkCmdPushConstants(handle(), pipeline.layout(), pipeline.stages(), 0, static_cast<std::uint32_t>(push.size()),
                       push.data());
}

} // namespace volmark::gpu
