#include "gpu/instance.h"

#include "volmark/error.h"
#include "volmark/gpu/device.h"

#include <algorithm>
#include <string_view>

namespace volmark::gpu {

namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL collect(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                       const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  auto& log = *static_cast<MessageLog*>(user);
  const std::lock_guard lock(log.mutex);
  log.messages.emplace_back(data->pMessage);
  return VK_FALSE;
}

bool layerIsThere() {
  std::uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  vkEnumerateInstanceLayerProperties(&count, layers.data());
  return std::any_of(layers.begin(), layers.end(), [](const VkLayerProperties& layer) {
    return std::string_view(layer.layerName) == kValidationLayer;
  });
}

VkDebugUtilsMessengerCreateInfoEXT messengerInfo(MessageLog* log) {
  VkDebugUtilsMessengerCreateInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  info.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  // Advice on performance is left out: a target in GENERAL layout is meant that way.
  info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  info.pfnUserCallback = collect;
  info.pUserData = log;
  return info;
}

template <class T> T function(VkInstance instance, const char* name) {
  return reinterpret_cast<T>(vkGetInstanceProcAddr(instance, name));
}

} // namespace

Instance::Instance(MessageLog* log) {
  if (log && !layerIsThere())
    throw UnsupportedError("validation was asked for, but the layer VK_LAYER_KHRONOS_validation is not installed "
                           "(Debian package vulkan-validationlayers)");
  const VkApplicationInfo application{
      VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, "volmark", 1, "volmark", 1, VK_API_VERSION_1_3};
  const VkValidationFeatureEnableEXT enabled[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = enabled;
  VkDebugUtilsMessengerCreateInfoEXT messenger = messengerInfo(log);
  messenger.pNext = &features;
  const char* const extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};

  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pApplicationInfo = &application;
  if (log) {
    info.pNext = &messenger;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &kValidationLayer;
    info.enabledExtensionCount = 1;
    info.ppEnabledExtensionNames = extensions;
  }
  const VkResult result = vkCreateInstance(&info, nullptr, &m_handle);
  // A loader without drivers answers so: a machine without Vulkan, not a failure.
  if (result != VK_SUCCESS) {
    m_handle = VK_NULL_HANDLE;
    if (result != VK_ERROR_INCOMPATIBLE_DRIVER) check(result, "vkCreateInstance");
  }
  if (!log || !m_handle) return;
  messenger.pNext = nullptr;
  check(function<PFN_vkCreateDebugUtilsMessengerEXT>(m_handle, "vkCreateDebugUtilsMessengerEXT")(m_handle, &messenger,
                                                                                                 nullptr, &m_messenger),
        "vkCreateDebugUtilsMessengerEXT");
}

Instance::~Instance() {
  if (m_messenger)
    function<PFN_vkDestroyDebugUtilsMessengerEXT>(m_handle, "vkDestroyDebugUtilsMessengerEXT")(m_handle, m_messenger,
                                                                                               nullptr);
  if (m_handle) vkDestroyInstance(m_handle, nullptr);
}

std::vector<VkPhysicalDevice> Instance::physicalDevices() const {
  std::uint32_t count = 0;
  if (!m_handle || vkEnumeratePhysicalDevices(m_handle, &count, nullptr) != VK_SUCCESS) return {};
  std::vector<VkPhysicalDevice> devices(count);
  if (vkEnumeratePhysicalDevices(m_handle, &count, devices.data()) < VK_SUCCESS) return {};
  devices.resize(count);
  return devices;
}

} // namespace volmark::gpu
