#include "gpu/device_features.h"

#include <fmt/format.h>

#include <algorithm>

namespace volmark::gpu {

namespace {

std::string typeName(VkPhysicalDeviceType type) {
  switch (type) {
  case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return "discrete";
  case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return "integrated";
  case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return "virtual";
  case VK_PHYSICAL_DEVICE_TYPE_CPU: return "cpu";
  default: return "other";
  }
}

std::vector<VkQueueFamilyProperties> queueFamilies(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  return families;
}

std::uint64_t localHeapBytes(VkPhysicalDevice device) {
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(device, &memory);
  std::uint64_t bytes = 0;
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) bytes += memory.memoryHeaps[i].size;
  return bytes;
}

void fillProperties(VkPhysicalDevice device, DeviceFacts& facts) {
  VkPhysicalDeviceVulkan13Properties vulkan13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES};
  VkPhysicalDeviceVulkan12Properties vulkan12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES, &vulkan13};
  VkPhysicalDeviceVulkan11Properties vulkan11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES, &vulkan12};
  VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &vulkan11};
  vkGetPhysicalDeviceProperties2(device, &all);
  const VkPhysicalDeviceLimits& limits = all.properties.limits;

  facts.driverName = vulkan12.driverName;
  facts.driverInfo = vulkan12.driverInfo;
  facts.subgroupSize = vulkan11.subgroupSize;
  facts.minimumSubgroupSize = vulkan13.minSubgroupSize;
  facts.maximumSubgroupSize = vulkan13.maxSubgroupSize;
  facts.maximumImageDimension2D = limits.maxImageDimension2D;
  facts.maximumImageDimension3D = limits.maxImageDimension3D;
  facts.maximumWorkgroupInvocations = limits.maxComputeWorkGroupInvocations;
  std::copy_n(limits.maxComputeWorkGroupCount, 3, facts.maximumWorkgroupCount);
  facts.maximumStorageBufferRange = limits.maxStorageBufferRange;
  facts.maximumAllocationBytes = vulkan11.maxMemoryAllocationSize;
  facts.deviceMemoryBytes = localHeapBytes(device);
  const int family = chooseQueueFamily(device);
  if (family >= 0)
    facts.timestampValidBits = queueFamilies(device)[static_cast<std::size_t>(family)].timestampValidBits;
  facts.subPixelBits = limits.subPixelPrecisionBits;
  facts.timestampPeriodNs = facts.timestampValidBits ? static_cast<double>(limits.timestampPeriod) : 0;
}

void fillMeshLimits(VkPhysicalDevice device, DeviceFacts& facts) {
  VkPhysicalDeviceMeshShaderPropertiesEXT mesh{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_PROPERTIES_EXT};
  VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &mesh};
  vkGetPhysicalDeviceProperties2(device, &all);
  std::copy_n(mesh.maxTaskWorkGroupCount, 3, facts.maximumTaskWorkgroups);
  facts.maximumTotalTaskWorkgroups = mesh.maxTaskWorkGroupTotalCount;
  facts.maximumMeshVertices = mesh.maxMeshOutputVertices;
  facts.maximumMeshPrimitives = mesh.maxMeshOutputPrimitives;
}

void fillFeatures(const DeviceFeatures& enabled, DeviceFacts& facts) {
  facts.meshShader = enabled.mesh.meshShader;
  facts.multiview = enabled.vulkan11.multiview;
  facts.vertexLayer = enabled.vulkan12.shaderOutputLayer;
  facts.int8 = enabled.vulkan12.shaderInt8 && enabled.vulkan12.storageBuffer8BitAccess;
  facts.int16 = enabled.core.features.shaderInt16 && enabled.vulkan11.storageBuffer16BitAccess;
  facts.int64 = enabled.core.features.shaderInt64;
  facts.int64BufferAtomics = enabled.vulkan12.shaderBufferInt64Atomics;
  facts.float64 = enabled.core.features.shaderFloat64;
  facts.fragmentStores = enabled.core.features.fragmentStoresAndAtomics;
  facts.vertexStores = enabled.core.features.vertexPipelineStoresAndAtomics;
  facts.representativeFragmentTest = enabled.representative.representativeFragmentTest;
  facts.subgroupSizeControl = enabled.vulkan13.subgroupSizeControl;
  facts.rayQuery = enabled.rayQuery.rayQuery;
  facts.pipelineStatistics = enabled.core.features.pipelineStatisticsQuery;
}

/// One sentence on the first thing that volmark can't do without, or nothing.
std::string whatIsMissing(VkPhysicalDevice device, const std::vector<VkExtensionProperties>& extensions,
                          const DeviceFeatures& enabled) {
  if (chooseQueueFamily(device) < 0) return "it has no queue for both graphics and compute";
  if (!contains(extensions, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME)) return "it lacks VK_KHR_push_descriptor";
  if (!enabled.vulkan12.scalarBlockLayout) return "it lacks the feature scalarBlockLayout";
  if (!enabled.vulkan12.bufferDeviceAddress) return "it lacks the feature bufferDeviceAddress";
  if (!enabled.vulkan13.synchronization2 || !enabled.vulkan13.dynamicRendering || !enabled.vulkan13.maintenance4)
    return "it lacks synchronization2, dynamicRendering or maintenance4";
  if (!enabled.core.features.shaderClipDistance || !enabled.core.features.fullDrawIndexUint32)
    return "it lacks shaderClipDistance or fullDrawIndexUint32";
  return {};
}

} // namespace

int chooseQueueFamily(VkPhysicalDevice device) {
  const auto families = queueFamilies(device);
  constexpr VkQueueFlags needed = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  for (std::size_t i = 0; i < families.size(); ++i)
    if ((families[i].queueFlags & needed) == needed) return static_cast<int>(i);
  return -1;
}

DeviceFacts queryFacts(VkPhysicalDevice device, int index) {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(device, &properties);
  DeviceFacts facts;
  facts.index = index;
  facts.name = properties.deviceName;
  facts.apiVersion =
      fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(properties.apiVersion), VK_API_VERSION_MINOR(properties.apiVersion),
                  VK_API_VERSION_PATCH(properties.apiVersion));
  facts.type = typeName(properties.deviceType);
  facts.vendorId = properties.vendorID;
  facts.deviceId = properties.deviceID;
  if (properties.apiVersion < VK_API_VERSION_1_3) {
    facts.missing = fmt::format("it offers Vulkan {}, and 1.3 is needed", facts.apiVersion);
    return facts;
  }
  fillProperties(device, facts);
  const auto extensions = deviceExtensions(device);
  DeviceFeatures supported(extensions);
  vkGetPhysicalDeviceFeatures2(device, &supported.core);
  DeviceFeatures enabled(extensions);
  chooseFeatures(supported, enabled);
  fillFeatures(enabled, facts);
  if (facts.meshShader) fillMeshLimits(device, facts);
  facts.missing = whatIsMissing(device, extensions, enabled);
  return facts;
}

} // namespace volmark::gpu
