#include "box_tree.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace volmark::empty_space_skipping {

namespace {

constexpr VkBuildAccelerationStructureFlagsKHR kFlags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;

constexpr gpu::Use kBuildRead{VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
                              VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR};
/// The scratch memory is read and written, too.
constexpr gpu::Use kBuild{VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
                          VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR |
                              VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR | VK_ACCESS_2_SHADER_READ_BIT};
constexpr gpu::Use kRays{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                         VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR | VK_ACCESS_2_SHADER_READ_BIT};

VkPhysicalDeviceAccelerationStructurePropertiesKHR propertiesOf(const gpu::Device& device) {
  VkPhysicalDeviceAccelerationStructurePropertiesKHR structures{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &structures};
  vkGetPhysicalDeviceProperties2(device.physical(), &properties);
  return structures;
}

gpu::Buffer bufferOf(gpu::Device& device, const char* name, VkDeviceSize bytes, VkBufferUsageFlags usage,
                     gpu::MemoryAccess access = gpu::MemoryAccess::device) {
  return {device,
          {.name = name, .bytes = bytes, .usage = usage | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT, .access = access}};
}

} // namespace

BoxTree::Functions::Functions(VkDevice device) {
  const auto load = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(vkGetDeviceProcAddr(device, name));
    assert(function);
  };
  load(create, "vkCreateAccelerationStructureKHR");
  load(destroy, "vkDestroyAccelerationStructureKHR");
  load(sizes, "vkGetAccelerationStructureBuildSizesKHR");
  load(address, "vkGetAccelerationStructureDeviceAddressKHR");
  load(build, "vkCmdBuildAccelerationStructuresKHR");
}

std::uint64_t BoxTree::mostBoxes(const gpu::Device& device) {
  return propertiesOf(device).maxPrimitiveCount;
}

BoxTree::BoxTree(gpu::Device& device, std::uint32_t most)
    : m_device(device), m_functions(device.handle()),
      m_boxes(bufferOf(device, "boxes", most * sizeof(BrickBox),
                       VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR |
                           VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT)),
      m_instance(bufferOf(device, "box_instance", sizeof(VkAccelerationStructureInstanceKHR),
                          VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR,
                          gpu::MemoryAccess::upload)) {
  VkDeviceSize scratch = 0;
  m_bottom = makeLevel(VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, boxGeometry(), most, scratch);
  m_top = makeLevel(VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, instanceGeometry(), 1, scratch);
  const VkDeviceSize alignment = propertiesOf(device).minAccelerationStructureScratchOffsetAlignment;
  m_scratch = bufferOf(device, "box_tree_scratch", scratch + alignment, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
  m_scratchAddress = (m_scratch.address() + alignment - 1) / alignment * alignment;

  const VkAccelerationStructureDeviceAddressInfoKHR info{
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR, nullptr, m_bottom.handle};
  VkAccelerationStructureInstanceKHR instance{};
  for (int axis = 0; axis < 3; ++axis)
    instance.transform.matrix[axis][axis] = 1;
  instance.mask = 0xff;
  instance.accelerationStructureReference = m_functions.address(device.handle(), &info);
  std::memcpy(m_instance.mapped().data(), &instance, sizeof(instance));
}

BoxTree::~BoxTree() {
  for (const Level* level : {&m_top, &m_bottom})
    if (level->handle) m_functions.destroy(m_device.handle(), level->handle, nullptr);
}

VkAccelerationStructureGeometryKHR BoxTree::boxGeometry() const {
  VkAccelerationStructureGeometryKHR geometry{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
  geometry.geometryType = VK_GEOMETRY_TYPE_AABBS_KHR;
  geometry.geometry.aabbs = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_AABBS_DATA_KHR,
                             nullptr,
                             {.deviceAddress = m_boxes.address()},
                             sizeof(BrickBox)};
  return geometry;
}

VkAccelerationStructureGeometryKHR BoxTree::instanceGeometry() const {
  VkAccelerationStructureGeometryKHR geometry{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
  geometry.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
  geometry.geometry.instances = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR,
                                 nullptr,
                                 VK_FALSE,
                                 {.deviceAddress = m_instance.address()}};
  return geometry;
}

BoxTree::Level BoxTree::makeLevel(VkAccelerationStructureTypeKHR type,
                                  const VkAccelerationStructureGeometryKHR& geometry, std::uint32_t most,
                                  VkDeviceSize& scratchBytes) {
  VkAccelerationStructureBuildGeometryInfoKHR build{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
  build.type = type;
  build.flags = kFlags;
  build.geometryCount = 1;
  build.pGeometries = &geometry;
  VkAccelerationStructureBuildSizesInfoKHR sizes{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
  m_functions.sizes(m_device.handle(), VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &build, &most, &sizes);
  scratchBytes = std::max(scratchBytes, sizes.buildScratchSize);

  Level level;
  level.memory = bufferOf(m_device, "box_tree", sizes.accelerationStructureSize,
                          VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR);
  VkAccelerationStructureCreateInfoKHR create{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR};
  create.buffer = level.memory.handle();
  create.size = sizes.accelerationStructureSize;
  create.type = type;
  gpu::check(m_functions.create(m_device.handle(), &create, nullptr, &level.handle),
             "vkCreateAccelerationStructureKHR");
  return level;
}

void BoxTree::buildLevel(gpu::Commands& commands, VkAccelerationStructureTypeKHR type, const Level& level,
                         const VkAccelerationStructureGeometryKHR& geometry, std::uint32_t count) const {
  VkAccelerationStructureBuildGeometryInfoKHR build{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
  build.type = type;
  build.flags = kFlags;
  build.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
  build.dstAccelerationStructure = level.handle;
  build.geometryCount = 1;
  build.pGeometries = &geometry;
  build.scratchData.deviceAddress = m_scratchAddress;
  const VkAccelerationStructureBuildRangeInfoKHR range{.primitiveCount = count};
  const VkAccelerationStructureBuildRangeInfoKHR* ranges = &range;
  m_functions.build(commands.handle(), 1, &build, &ranges);
}

void BoxTree::build(gpu::Commands& commands, std::span<const BrickBox> boxes) {
  // Rays and builds of earlier frames.
  commands.barrier(kRays, gpu::kTransferWrite);
  commands.barrier(kBuild, gpu::kTransferWrite);
  // Where nothing is visible, one box that no ray meets.
  static constexpr BrickBox kNowhere{vec3(-2e6f), vec3(-1e6f)};
  if (boxes.empty()) boxes = {&kNowhere, 1};
  commands.upload(m_boxes, 0, std::as_bytes(boxes));
  commands.barrier(gpu::kTransferWrite, kBuildRead);
  commands.barrier(gpu::kTransferWrite, kRays);
  commands.barrier(kRays, kBuild);
  buildLevel(commands, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, m_bottom, boxGeometry(),
             static_cast<std::uint32_t>(boxes.size()));
  commands.barrier(kBuild, kBuild);
  buildLevel(commands, VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, m_top, instanceGeometry(), 1);
  commands.barrier(kBuild, kRays);
}

} // namespace volmark::empty_space_skipping
