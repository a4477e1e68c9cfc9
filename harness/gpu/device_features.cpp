#include "gpu/device_features.h"

#include <algorithm>

namespace volmark::gpu {

namespace {

constexpr VkBool32 VkPhysicalDeviceFeatures::*kCore[] = {
    &VkPhysicalDeviceFeatures::shaderInt64,
    &VkPhysicalDeviceFeatures::shaderInt16,
    &VkPhysicalDeviceFeatures::shaderFloat64,
    &VkPhysicalDeviceFeatures::pipelineStatisticsQuery,
    &VkPhysicalDeviceFeatures::occlusionQueryPrecise,
    &VkPhysicalDeviceFeatures::fragmentStoresAndAtomics,
    &VkPhysicalDeviceFeatures::vertexPipelineStoresAndAtomics,
    &VkPhysicalDeviceFeatures::shaderStorageImageExtendedFormats,
    &VkPhysicalDeviceFeatures::shaderStorageImageReadWithoutFormat,
    &VkPhysicalDeviceFeatures::shaderStorageImageWriteWithoutFormat,
    &VkPhysicalDeviceFeatures::shaderClipDistance,
    &VkPhysicalDeviceFeatures::shaderCullDistance,
    &VkPhysicalDeviceFeatures::sampleRateShading,
    &VkPhysicalDeviceFeatures::independentBlend,
    &VkPhysicalDeviceFeatures::multiDrawIndirect,
    &VkPhysicalDeviceFeatures::drawIndirectFirstInstance,
    &VkPhysicalDeviceFeatures::fullDrawIndexUint32,
    &VkPhysicalDeviceFeatures::geometryShader,
    &VkPhysicalDeviceFeatures::depthClamp,
    &VkPhysicalDeviceFeatures::largePoints,
};
constexpr VkBool32 VkPhysicalDeviceVulkan11Features::*kVulkan11[] = {
    &VkPhysicalDeviceVulkan11Features::multiview,
    &VkPhysicalDeviceVulkan11Features::storageBuffer16BitAccess,
    &VkPhysicalDeviceVulkan11Features::uniformAndStorageBuffer16BitAccess,
    &VkPhysicalDeviceVulkan11Features::shaderDrawParameters,
};
constexpr VkBool32 VkPhysicalDeviceVulkan12Features::*kVulkan12[] = {
    &VkPhysicalDeviceVulkan12Features::scalarBlockLayout,
    &VkPhysicalDeviceVulkan12Features::bufferDeviceAddress,
    &VkPhysicalDeviceVulkan12Features::shaderBufferInt64Atomics,
    &VkPhysicalDeviceVulkan12Features::shaderSharedInt64Atomics,
    &VkPhysicalDeviceVulkan12Features::storageBuffer8BitAccess,
    &VkPhysicalDeviceVulkan12Features::uniformAndStorageBuffer8BitAccess,
    &VkPhysicalDeviceVulkan12Features::shaderInt8,
    &VkPhysicalDeviceVulkan12Features::shaderFloat16,
    &VkPhysicalDeviceVulkan12Features::drawIndirectCount,
    &VkPhysicalDeviceVulkan12Features::shaderOutputLayer,
    &VkPhysicalDeviceVulkan12Features::shaderOutputViewportIndex,
    &VkPhysicalDeviceVulkan12Features::shaderSubgroupExtendedTypes,
    &VkPhysicalDeviceVulkan12Features::subgroupBroadcastDynamicId,
    &VkPhysicalDeviceVulkan12Features::samplerFilterMinmax,
    &VkPhysicalDeviceVulkan12Features::vulkanMemoryModel,
    &VkPhysicalDeviceVulkan12Features::vulkanMemoryModelDeviceScope,
};
constexpr VkBool32 VkPhysicalDeviceVulkan13Features::*kVulkan13[] = {
    &VkPhysicalDeviceVulkan13Features::synchronization2,
    &VkPhysicalDeviceVulkan13Features::dynamicRendering,
    &VkPhysicalDeviceVulkan13Features::maintenance4,
    &VkPhysicalDeviceVulkan13Features::subgroupSizeControl,
    &VkPhysicalDeviceVulkan13Features::computeFullSubgroups,
    &VkPhysicalDeviceVulkan13Features::shaderDemoteToHelperInvocation,
    &VkPhysicalDeviceVulkan13Features::shaderTerminateInvocation,
    &VkPhysicalDeviceVulkan13Features::shaderZeroInitializeWorkgroupMemory,
    &VkPhysicalDeviceVulkan13Features::shaderIntegerDotProduct,
};

template <class Struct, std::size_t n>
void copyFlags(const Struct& from, Struct& to, VkBool32 Struct::*const (&members)[n]) {
  for (const auto member : members)
    to.*member = from.*member;
}

} // namespace

std::vector<VkExtensionProperties> deviceExtensions(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr), "vkEnumerateDeviceExtensionProperties");
  std::vector<VkExtensionProperties> extensions(count);
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data()),
        "vkEnumerateDeviceExtensionProperties");
  return extensions;
}

bool contains(const std::vector<VkExtensionProperties>& extensions, std::string_view name) {
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const VkExtensionProperties& extension) { return name == extension.extensionName; });
}

DeviceFeatures::DeviceFeatures(const std::vector<VkExtensionProperties>& extensions) {
  core.pNext = &vulkan11;
  vulkan11.pNext = &vulkan12;
  vulkan12.pNext = &vulkan13;
  void** end = &vulkan13.pNext;
  if (contains(extensions, VK_EXT_MESH_SHADER_EXTENSION_NAME)) {
    *end = &mesh;
    end = &mesh.pNext;
  }
  if (contains(extensions, VK_NV_REPRESENTATIVE_FRAGMENT_TEST_EXTENSION_NAME)) {
    *end = &representative;
    end = &representative.pNext;
  }
  if (contains(extensions, VK_KHR_RAY_QUERY_EXTENSION_NAME) &&
      contains(extensions, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME) &&
      contains(extensions, VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME)) {
    *end = &rayQuery;
    rayQuery.pNext = &acceleration;
  }
}

void chooseFeatures(const DeviceFeatures& supported, DeviceFeatures& enabled) {
  copyFlags(supported.core.features, enabled.core.features, kCore);
  copyFlags(supported.vulkan11, enabled.vulkan11, kVulkan11);
  copyFlags(supported.vulkan12, enabled.vulkan12, kVulkan12);
  copyFlags(supported.vulkan13, enabled.vulkan13, kVulkan13);
  enabled.mesh.taskShader = enabled.mesh.meshShader = supported.mesh.taskShader && supported.mesh.meshShader;
  enabled.mesh.meshShaderQueries = enabled.mesh.meshShader && supported.mesh.meshShaderQueries;
  enabled.representative.representativeFragmentTest = supported.representative.representativeFragmentTest;
  enabled.rayQuery.rayQuery = enabled.acceleration.accelerationStructure =
      supported.rayQuery.rayQuery && supported.acceleration.accelerationStructure;
}

std::vector<const char*> chooseExtensions(const DeviceFeatures& enabled) {
  std::vector<const char*> names = {VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME};
  if (enabled.mesh.meshShader) names.push_back(VK_EXT_MESH_SHADER_EXTENSION_NAME);
  if (enabled.representative.representativeFragmentTest)
    names.push_back(VK_NV_REPRESENTATIVE_FRAGMENT_TEST_EXTENSION_NAME);
  if (enabled.rayQuery.rayQuery)
    names.insert(names.end(), {VK_KHR_RAY_QUERY_EXTENSION_NAME, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                               VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME});
  return names;
}

} // namespace volmark::gpu
