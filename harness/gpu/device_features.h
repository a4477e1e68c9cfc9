// What a physical device offers, and what volmark switches on of it.
#pragma once

#include "volmark/gpu/device.h"

#include <vulkan/vulkan.h>

#include <string_view>
#include <vector>

namespace volmark::gpu {

/// Chained feature structs; holds pointers into itself.
struct DeviceFeatures {
  /// Zeroed; `extensions` decides which structs are chained.
  explicit DeviceFeatures(const std::vector<VkExtensionProperties>& extensions);
  DeviceFeatures(const DeviceFeatures&) = delete;
  DeviceFeatures& operator=(const DeviceFeatures&) = delete;

  VkPhysicalDeviceFeatures2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  VkPhysicalDeviceVulkan11Features vulkan11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
  VkPhysicalDeviceVulkan12Features vulkan12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceVulkan13Features vulkan13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceMeshShaderFeaturesEXT mesh{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_FEATURES_EXT};
  VkPhysicalDeviceRepresentativeFragmentTestFeaturesNV representative{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_REPRESENTATIVE_FRAGMENT_TEST_FEATURES_NV};
  VkPhysicalDeviceRayQueryFeaturesKHR rayQuery{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR};
  VkPhysicalDeviceAccelerationStructureFeaturesKHR acceleration{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR};
};

std::vector<VkExtensionProperties> deviceExtensions(VkPhysicalDevice device);
bool contains(const std::vector<VkExtensionProperties>& extensions, std::string_view name);

/// Copies to `enabled` what volmark uses of `supported`.
void chooseFeatures(const DeviceFeatures& supported, DeviceFeatures& enabled);

/// Extensions to switch on, given what chooseFeatures() left on.
std::vector<const char*> chooseExtensions(const DeviceFeatures& enabled);

/// Index of a queue family that does graphics and compute, or -1.
int chooseQueueFamily(VkPhysicalDevice device);

DeviceFacts queryFacts(VkPhysicalDevice device, int index);

} // namespace volmark::gpu
