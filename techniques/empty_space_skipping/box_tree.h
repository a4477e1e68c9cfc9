// Axis-aligned boxes in an acceleration structure of the device.
#pragma once

#include "shared.h"
#include "volmark/gpu/buffer.h"
#include "volmark/gpu/commands.h"

#include <span>

namespace volmark::empty_space_skipping {

/// A bottom level of boxes and a top level with one instance of it.
class BoxTree {
public:
  /// Memory for up to `most` boxes. The device must have ray queries.
  BoxTree(gpu::Device& device, std::uint32_t most);
  ~BoxTree();
  BoxTree(const BoxTree&) = delete;
  BoxTree& operator=(const BoxTree&) = delete;

  /// How many boxes a device takes.
  static std::uint64_t mostBoxes(const gpu::Device& device);

  /// Records the upload and both builds; rays of compute shaders may follow.
  void build(gpu::Commands& commands, std::span<const BrickBox> boxes);

  gpu::AccelerationStructure structure() const { return {m_top.handle}; }
  gpu::BufferRange boxes() const { return m_boxes.range(); }

private:
  struct Functions {
    explicit Functions(VkDevice device);
    PFN_vkCreateAccelerationStructureKHR create;
    PFN_vkDestroyAccelerationStructureKHR destroy;
    PFN_vkGetAccelerationStructureBuildSizesKHR sizes;
    PFN_vkGetAccelerationStructureDeviceAddressKHR address;
    PFN_vkCmdBuildAccelerationStructuresKHR build;
  };
  struct Level {
    gpu::Buffer memory;
    VkAccelerationStructureKHR handle = VK_NULL_HANDLE;
  };
  /// Of `geometry`, with room for `most` primitives; raises `scratchBytes` to what its build needs.
  Level makeLevel(VkAccelerationStructureTypeKHR type, const VkAccelerationStructureGeometryKHR& geometry,
                  std::uint32_t most, VkDeviceSize& scratchBytes);
  void buildLevel(gpu::Commands& commands, VkAccelerationStructureTypeKHR type, const Level& level,
                  const VkAccelerationStructureGeometryKHR& geometry, std::uint32_t count) const;
  VkAccelerationStructureGeometryKHR boxGeometry() const;
  VkAccelerationStructureGeometryKHR instanceGeometry() const;

  gpu::Device& m_device;
  Functions m_functions;
  gpu::Buffer m_boxes;
  gpu::Buffer m_instance;
  gpu::Buffer m_scratch;
  VkDeviceAddress m_scratchAddress = 0;
  Level m_bottom;
  Level m_top;
};

} // namespace volmark::empty_space_skipping
