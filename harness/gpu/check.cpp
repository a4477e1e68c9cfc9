#include "volmark/error.h"
#include "volmark/gpu/device.h"

#include <fmt/format.h>

namespace volmark::gpu {

namespace {

std::string nameOf(VkResult result) {
  switch (result) {
  case VK_NOT_READY: return "not ready";
  case VK_TIMEOUT: return "timeout";
  case VK_INCOMPLETE: return "incomplete";
  case VK_ERROR_OUT_OF_HOST_MEMORY: return "out of host memory";
  case VK_ERROR_OUT_OF_DEVICE_MEMORY: return "out of device memory";
  case VK_ERROR_INITIALIZATION_FAILED: return "initialisation failed";
  case VK_ERROR_DEVICE_LOST: return "device lost";
  case VK_ERROR_MEMORY_MAP_FAILED: return "mapping failed";
  case VK_ERROR_LAYER_NOT_PRESENT: return "layer not present";
  case VK_ERROR_EXTENSION_NOT_PRESENT: return "extension not present";
  case VK_ERROR_FEATURE_NOT_PRESENT: return "feature not present";
  case VK_ERROR_INCOMPATIBLE_DRIVER: return "incompatible driver";
  case VK_ERROR_TOO_MANY_OBJECTS: return "too many objects";
  case VK_ERROR_FORMAT_NOT_SUPPORTED: return "format not supported";
  case VK_ERROR_INVALID_OPAQUE_CAPTURE_ADDRESS: return "invalid capture address";
  case VK_PIPELINE_COMPILE_REQUIRED: return "pipeline compile required";
  default: return fmt::format("VkResult {}", static_cast<int>(result));
  }
}

} // namespace

void check(VkResult result, const char* what) {
  if (result == VK_SUCCESS) return;
  switch (result) {
  case VK_ERROR_OUT_OF_HOST_MEMORY:
  case VK_ERROR_OUT_OF_DEVICE_MEMORY:
  case VK_ERROR_TOO_MANY_OBJECTS: throw UnsupportedError(fmt::format("{} failed: {}", what, nameOf(result)));
  case VK_ERROR_DEVICE_LOST:
    throw DeviceError(fmt::format("{} failed: the GPU stopped answering and was reset (device lost); a shader may have "
                                  "run too long or touched memory that is not its own",
                                  what));
  default:
    throw DeviceError(fmt::format("{} failed: {} (VkResult {})", what, nameOf(result), static_cast<int>(result)));
  }
}

} // namespace volmark::gpu
