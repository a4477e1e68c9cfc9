// The Vulkan instance, with or without validation.
#pragma once

#include <vulkan/vulkan.h>

#include <mutex>
#include <string>
#include <vector>

namespace volmark::gpu {

/// Messages of the validation layer; filled from any thread.
struct MessageLog {
  mutable std::mutex mutex;
  std::vector<std::string> messages;
};

/// Move-less owner of a VkInstance and its debug messenger.
class Instance {
public:
  /// `log` null: no validation. Throws UnsupportedError when the validation layer is missing; handle() is null
  /// when the machine has no Vulkan.
  explicit Instance(MessageLog* log);
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  VkInstance handle() const { return m_handle; }
  /// In the loader's order.
  std::vector<VkPhysicalDevice> physicalDevices() const;

private:
  VkInstance m_handle = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT m_messenger = VK_NULL_HANDLE;
};

} // namespace volmark::gpu
