// A Vulkan layer that hides one device extension, named by VOLMARK_TEST_HIDE: what a device without it looks like.
#include <vulkan/vk_layer.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <vector>

namespace {

// The tests have one instance in a process at a time.
PFN_vkGetInstanceProcAddr next = nullptr;
PFN_vkEnumerateDeviceExtensionProperties nextEnumerate = nullptr;

VKAPI_ATTR VkResult VKAPI_CALL createInstance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                                              VkInstance* created) {
  auto* link = static_cast<VkLayerInstanceCreateInfo*>(const_cast<void*>(info->pNext));
  while (link && (link->sType != VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO || link->function != VK_LAYER_LINK_INFO))
    link = static_cast<VkLayerInstanceCreateInfo*>(const_cast<void*>(link->pNext));
  if (!link) return VK_ERROR_INITIALIZATION_FAILED;
  next = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateInstance>(next(VK_NULL_HANDLE, "vkCreateInstance"));
  const VkResult result = create(info, allocator, created);
  // Asked for later, the loader would answer with this layer's own.
  if (result == VK_SUCCESS)
    nextEnumerate = reinterpret_cast<PFN_vkEnumerateDeviceExtensionProperties>(
        next(*created, "vkEnumerateDeviceExtensionProperties"));
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL enumerateExtensions(VkPhysicalDevice device, const char* layer, std::uint32_t* count,
                                                   VkExtensionProperties* properties) {
  std::uint32_t all = 0;
  if (const VkResult result = nextEnumerate(device, layer, &all, nullptr); result != VK_SUCCESS) return result;
  std::vector<VkExtensionProperties> shown(all);
  if (const VkResult result = nextEnumerate(device, layer, &all, shown.data()); result != VK_SUCCESS) return result;
  const char* hidden = std::getenv("VOLMARK_TEST_HIDE");
  std::erase_if(
      shown, [&](const VkExtensionProperties& one) { return hidden && std::string_view(one.extensionName) == hidden; });
  if (!properties) {
    *count = static_cast<std::uint32_t>(shown.size());
    return VK_SUCCESS;
  }
  const std::size_t room = std::min<std::size_t>(*count, shown.size());
  std::copy_n(shown.begin(), room, properties);
  *count = static_cast<std::uint32_t>(room);
  return room < shown.size() ? VK_INCOMPLETE : VK_SUCCESS;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getInstanceFunction(VkInstance of, const char* name) {
  if (!std::strcmp(name, "vkGetInstanceProcAddr")) return reinterpret_cast<PFN_vkVoidFunction>(getInstanceFunction);
  if (!std::strcmp(name, "vkCreateInstance")) return reinterpret_cast<PFN_vkVoidFunction>(createInstance);
  if (!std::strcmp(name, "vkEnumerateDeviceExtensionProperties"))
    return reinterpret_cast<PFN_vkVoidFunction>(enumerateExtensions);
  return next ? next(of, name) : nullptr;
}

} // namespace

extern "C" VK_LAYER_EXPORT VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* negotiated) {
  negotiated->loaderLayerInterfaceVersion = std::min(negotiated->loaderLayerInterfaceVersion, 2u);
  negotiated->pfnGetInstanceProcAddr = getInstanceFunction;
  negotiated->pfnGetDeviceProcAddr = nullptr;
  negotiated->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}
