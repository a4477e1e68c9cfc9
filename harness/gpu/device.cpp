#include "volmark/gpu/device.h"

#include "gpu/device_features.h"
#include "gpu/instance.h"
#include "volmark/error.h"
#include "volmark/gpu/driver_environment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cctype>

namespace volmark::gpu {

namespace {

std::vector<DeviceFacts> factsOf(const std::vector<VkPhysicalDevice>& devices) {
  std::vector<DeviceFacts> result;
  for (const VkPhysicalDevice device : devices)
    result.push_back(queryFacts(device, static_cast<int>(result.size())));
  return result;
}

std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Smaller is better; devices that can't be used come last.
int rankOf(const DeviceFacts& facts) {
  constexpr const char* order[] = {"discrete", "integrated", "virtual", "cpu"};
  const auto found = std::find(std::begin(order), std::end(order), facts.type);
  return static_cast<int>(found - std::begin(order)) + (facts.missing.empty() ? 0 : 100);
}

bool matches(const DeviceFacts& facts, const std::string& selector) {
  if (selector.empty()) return true;
  const bool isIndex = std::all_of(selector.begin(), selector.end(), [](unsigned char c) { return std::isdigit(c); });
  if (isIndex) return selector == std::to_string(facts.index);
  return lowerCase(facts.name).find(lowerCase(selector)) != std::string::npos;
}

DeviceFacts choose(const std::vector<DeviceFacts>& all, const std::string& selector) {
  if (all.empty())
    throw UnsupportedError("no Vulkan device was found (Debian package mesa-vulkan-drivers draws on the CPU)");
  const DeviceFacts* best = nullptr;
  for (const DeviceFacts& facts : all)
    if (matches(facts, selector) && (!best || rankOf(facts) < rankOf(*best))) best = &facts;
  if (!best) {
    std::string list;
    for (const DeviceFacts& facts : all)
      list += fmt::format("{}{}: {}", list.empty() ? "" : ", ", facts.index, facts.name);
    throw InputError(fmt::format("device: found \"{}\", allowed: an index or a part of a name of {}", selector, list));
  }
  if (!best->missing.empty())
    throw UnsupportedError(fmt::format("the device {} can't be used: {}", best->name, best->missing));
  return *best;
}

} // namespace

struct Device::Implementation {
  explicit Implementation(bool validates) : validate(validates), instance(validates ? &log : nullptr) {}

  bool validate;
  MessageLog log;
  Instance instance;
  DeviceFacts facts;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkPhysicalDeviceMemoryProperties memory{};
  std::uint32_t queueFamily = 0;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  PFN_vkSetDebugUtilsObjectNameEXT setObjectName = nullptr;
  MemoryLedger ledger;

  void createDevice();
  template <class T> void load(T& function, const char* name) {
    function = reinterpret_cast<T>(vkGetDeviceProcAddr(device, name));
  }
};

void Device::Implementation::createDevice() {
  const auto extensions = deviceExtensions(physical);
  DeviceFeatures supported(extensions);
  vkGetPhysicalDeviceFeatures2(physical, &supported.core);
  DeviceFeatures enabled(extensions);
  chooseFeatures(supported, enabled);
  // An extension whose feature is off is not enabled, and its struct must then not be chained.
  std::vector<VkExtensionProperties> chained;
  const std::vector<const char*> names = chooseExtensions(enabled);
  for (const VkExtensionProperties& extension : extensions)
    if (std::find(names.begin(), names.end(), std::string_view(extension.extensionName)) != names.end())
      chained.push_back(extension);
  DeviceFeatures features(chained);
  chooseFeatures(supported, features);

  queueFamily = static_cast<std::uint32_t>(chooseQueueFamily(physical));
  const float priority = 1;
  VkDeviceQueueCreateInfo queueInfo{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queueInfo.queueFamilyIndex = queueFamily;
  queueInfo.queueCount = 1;
  queueInfo.pQueuePriorities = &priority;
  VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &features.core};
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queueInfo;
  info.enabledExtensionCount = static_cast<std::uint32_t>(names.size());
  info.ppEnabledExtensionNames = names.data();
  check(vkCreateDevice(physical, &info, nullptr, &device), "vkCreateDevice");
  vkGetDeviceQueue(device, queueFamily, 0, &queue);
  vkGetPhysicalDeviceMemoryProperties(physical, &memory);
  if (validate) load(setObjectName, "vkSetDebugUtilsObjectNameEXT");
}

std::vector<DeviceFacts> listDevices() {
  prepareDriverEnvironment();
  try {
    return factsOf(Instance(nullptr).physicalDevices());
  } catch (const std::runtime_error&) {
    return {};
  }
}

Device::Device(const DeviceOptions& options) {
  prepareDriverEnvironment();
  m_implementation = std::make_unique<Implementation>(options.validate);
  Implementation& my = *m_implementation;
  const auto devices = my.instance.physicalDevices();
  my.facts = choose(factsOf(devices), options.selector);
  my.physical = devices.at(static_cast<std::size_t>(my.facts.index));
  my.createDevice();
  my.load(cmdPushDescriptorSet, "vkCmdPushDescriptorSetKHR");
  if (!my.facts.meshShader) return;
  my.load(cmdDrawMeshTasks, "vkCmdDrawMeshTasksEXT");
  my.load(cmdDrawMeshTasksIndirect, "vkCmdDrawMeshTasksIndirectEXT");
  my.load(cmdDrawMeshTasksIndirectCount, "vkCmdDrawMeshTasksIndirectCountEXT");
}

Device::~Device() {
  vkDeviceWaitIdle(m_implementation->device);
  vkDestroyDevice(m_implementation->device, nullptr);
}

const DeviceFacts& Device::facts() const {
  return m_implementation->facts;
}

VkInstance Device::instance() const {
  return m_implementation->instance.handle();
}

VkPhysicalDevice Device::physical() const {
  return m_implementation->physical;
}

VkDevice Device::handle() const {
  return m_implementation->device;
}

VkQueue Device::queue() const {
  return m_implementation->queue;
}

std::uint32_t Device::queueFamily() const {
  return m_implementation->queueFamily;
}

MemoryLedger& Device::ledger() {
  return m_implementation->ledger;
}

bool Device::filtersLinearly(VkFormat format) const {
  return supports(format, VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT);
}

bool Device::supports(VkFormat format, VkFormatFeatureFlags features) const {
  VkFormatProperties properties;
  vkGetPhysicalDeviceFormatProperties(physical(), format, &properties);
  return (properties.optimalTilingFeatures & features) == features;
}

std::uint32_t Device::memoryType(std::uint32_t allowedBits, VkMemoryPropertyFlags required,
                                 VkMemoryPropertyFlags preferred) const {
  const VkPhysicalDeviceMemoryProperties& memory = m_implementation->memory;
  for (const VkMemoryPropertyFlags wanted : {required | preferred, required})
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i)
      if ((allowedBits >> i & 1u) && (memory.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
  throw UnsupportedError(
      fmt::format("the device {} has no memory of the kind that is needed (flags {:#x})", facts().name, required));
}

std::vector<std::string> Device::validationMessages() const {
  const std::lock_guard lock(m_implementation->log.mutex);
  return m_implementation->log.messages;
}

void Device::waitIdle() const {
  check(vkDeviceWaitIdle(handle()), "vkDeviceWaitIdle");
}

void Device::setName(VkObjectType type, std::uint64_t handle, const std::string& name) const {
  if (!m_implementation->setObjectName) return;
  const VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT, nullptr, type, handle,
                                           name.c_str()};
  m_implementation->setObjectName(m_implementation->device, &info);
}

} // namespace volmark::gpu
