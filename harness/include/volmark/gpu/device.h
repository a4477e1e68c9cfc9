// Vulkan device: choice, facts, queue, validation messages.
#pragma once

#include "volmark/gpu/memory_ledger.h"

#include <vulkan/vulkan.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace volmark::gpu {

/// What a device is and can do, queried, never assumed. Written to every run's provenance.
struct DeviceFacts {
  int index = 0;          ///< position in listDevices()
  std::string name;       ///< VkPhysicalDeviceProperties::deviceName
  std::string driverName; ///< "llvmpipe", "NVIDIA", ...
  std::string driverInfo; ///< driver version as the driver words it
  std::string apiVersion; ///< "1.4.305"
  std::string type;       ///< "discrete", "integrated", "virtual", "cpu" or "other"
  std::uint32_t vendorId = 0;
  std::uint32_t deviceId = 0;

  std::uint32_t subgroupSize = 0;
  std::uint32_t minimumSubgroupSize = 0;
  std::uint32_t maximumSubgroupSize = 0;
  std::uint32_t maximumImageDimension2D = 0;
  std::uint32_t maximumImageDimension3D = 0;
  std::uint32_t maximumWorkgroupInvocations = 0;
  std::uint32_t maximumWorkgroupCount[3] = {0, 0, 0};
  std::uint64_t maximumStorageBufferRange = 0;
  std::uint64_t maximumAllocationBytes = 0;
  std::uint64_t deviceMemoryBytes = 0; ///< sum of the device-local heaps
  double timestampPeriodNs = 0;        ///< 0: the queue has no timestamps
  std::uint32_t timestampValidBits = 0;

  bool meshShader = false;                      ///< task and mesh shaders; their limits are 0 without
  std::uint32_t maximumTaskWorkgroups[3]{};     ///< of one draw, along each dimension
  std::uint32_t maximumTotalTaskWorkgroups = 0; ///< their product
  std::uint32_t maximumMeshVertices = 0;        ///< that one workgroup writes
  std::uint32_t maximumMeshPrimitives = 0;
  bool representativeFragmentTest = false; ///< VK_NV_representative_fragment_test
  std::uint32_t subPixelBits = 0;          ///< vertices snap to 2^-bits of a pixel
  bool multiview = false;
  bool vertexLayer = false; ///< vertex shaders write gl_Layer
  bool int8 = false;        ///< arithmetic and storage buffers
  bool int16 = false;       ///< arithmetic and storage buffers
  bool int64 = false;
  bool int64BufferAtomics = false;
  bool float64 = false;
  bool fragmentStores = false; ///< storage writes and atomics in fragment shaders
  bool vertexStores = false;   ///< and in those before rasterization
  bool subgroupSizeControl = false;
  bool rayQuery = false; ///< with acceleration structures
  bool pipelineStatistics = false;

  std::string missing; ///< why volmark can't use this device at all (one sentence), or empty
};

struct DeviceOptions {
  std::string selector;  ///< empty: best type first; else an index or a part of the name, any case
  bool validate = false; ///< load the Khronos validation layer, with synchronisation validation
};

/// All devices of the loader. Never throws for a machine without Vulkan: the list is empty then.
std::vector<DeviceFacts> listDevices();

/// One logical device with one queue that does graphics, compute and transfer. Not movable: resources refer
/// to it and must be destroyed first (the ledger is empty then).
class Device {
public:
  /// Throws InputError when the selector matches nothing (lists the devices) and UnsupportedError when no
  /// usable device or no validation layer is there.
  explicit Device(const DeviceOptions& options);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceFacts& facts() const;
  VkInstance instance() const;
  VkPhysicalDevice physical() const;
  VkDevice handle() const;
  VkQueue queue() const;
  std::uint32_t queueFamily() const;
  MemoryLedger& ledger();

  /// The linear filter of optimal-tiling images works for `format` (sampled images, blits).
  bool filtersLinearly(VkFormat format) const;
  /// Optimal-tiling images of `format` can be used as `features` says.
  bool supports(VkFormat format, VkFormatFeatureFlags features) const;
  /// Index of a memory type with all `required` flags and, if one has them, all `preferred` ones.
  std::uint32_t memoryType(std::uint32_t allowedBits, VkMemoryPropertyFlags required,
                           VkMemoryPropertyFlags preferred = 0) const;

  /// Warnings and errors of the validation layer so far, oldest first.
  std::vector<std::string> validationMessages() const;

  void waitIdle() const;

  /// Gives an object the name that validation messages call it by; nothing without validation.
  void setName(VkObjectType type, std::uint64_t handle, const std::string& name) const;

  /// Extension commands that the loader does not export.
  PFN_vkCmdPushDescriptorSetKHR cmdPushDescriptorSet = nullptr;
  PFN_vkCmdDrawMeshTasksEXT cmdDrawMeshTasks = nullptr;
  PFN_vkCmdDrawMeshTasksIndirectEXT cmdDrawMeshTasksIndirect = nullptr;
  PFN_vkCmdDrawMeshTasksIndirectCountEXT cmdDrawMeshTasksIndirectCount = nullptr;

private:
  struct Implementation;
  std::unique_ptr<Implementation> m_implementation;
};

/// Throws DeviceError naming `what` and the VkResult unless `result` is VK_SUCCESS. VK_ERROR_DEVICE_LOST
/// says so in plain words; out-of-memory results throw UnsupportedError.
void check(VkResult result, const char* what);

} // namespace volmark::gpu
