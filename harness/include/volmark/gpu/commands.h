// What a technique records on the GPU within a pass of its Recorder.
#pragma once

#include "volmark/gpu/buffer.h"
#include "volmark/gpu/image.h"
#include "volmark/gpu/pipeline.h"

#include <glm/glm.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <variant>
#include <vector>

namespace volmark::gpu {

struct StorageImage {
  VkImageView view; ///< in VK_IMAGE_LAYOUT_GENERAL
};
struct SampledImage {
  VkImageView view;
  VkSampler sampler;
  VkImageLayout layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
};
struct AccelerationStructure {
  VkAccelerationStructureKHR handle;
};
/// What is bound to one slot; the descriptor type comes from the pipeline's layout.
using Resource = std::variant<BufferRange, StorageImage, SampledImage, AccelerationStructure>;

/// Memory dependency between two uses; exact on purpose, so that a missing one can be seen in review.
struct Use {
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 access;
};
inline constexpr Use kComputeRead{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_READ_BIT};
inline constexpr Use kComputeWrite{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_WRITE_BIT};
inline constexpr Use kComputeReadWrite{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                       VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT};
inline constexpr Use kTransferRead{VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};
inline constexpr Use kTransferWrite{VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};
inline constexpr Use kHostRead{VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT};
inline constexpr Use kIndirectRead{VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT};
inline constexpr Use kAnything{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                               VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};

/// How long Commands::wait() waits for an answer of the GPU.
inline constexpr std::chrono::seconds kGpuTimeout{60};

/// One command buffer being recorded, with the upload memory of its frame slot. Waiting, submitting and
/// stamps belong to the harness.
class Commands {
public:
  explicit Commands(Device& device);
  ~Commands();
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;

  Device& device() { return m_device; }
  VkCommandBuffer handle() const;

  /// Copies `bytes` into memory that lives until this frame has finished; bind it as a uniform or storage
  /// buffer.
  BufferRange constants(std::span<const std::byte> bytes);
  /// One value of a trivially copyable type that is not itself a range.
  template <class T>
  requires(std::is_trivially_copyable_v<T> && !requires(const T& value) { value.data(); }) BufferRange
      constants(const T& value) {
    return constants(std::span<const std::byte>(std::as_bytes(std::span<const T, 1>(&value, 1))));
  }

  /// Binds the pipeline with all its resources, in the order of its layout, and its push constants. Throws
  /// std::logic_error when they don't match the layout.
  void bind(const Pipeline& pipeline, std::span<const Resource> resources, std::span<const std::byte> push = {});
  void dispatch(const Pipeline& pipeline, std::span<const Resource> resources, std::span<const std::byte> push,
                glm::uvec3 groups);
  void dispatchIndirect(const Pipeline& pipeline, std::span<const Resource> resources, std::span<const std::byte> push,
                        const BufferRange& arguments);

  /// Copies through staging memory of this frame slot; the caller adds barriers around it.
  void upload(const Buffer& destination, VkDeviceSize offset, std::span<const std::byte> bytes);
  /// Whole image, tightly packed; leaves it in SHADER_READ_ONLY_OPTIMAL, visible to all shaders.
  void upload(const Image& destination, std::span<const std::byte> bytes);
  /// Slices [first, first+count) of a 3-D image in VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL; the caller transitions.
  void uploadSlab(const Image& destination, std::uint32_t first, std::uint32_t count, std::span<const std::byte> bytes);
  void fill(const Buffer& destination, std::uint32_t word);

  void barrier(const Use& before, const Use& after);
  void transition(const Image& image, VkImageLayout from, VkImageLayout to, const Use& before, const Use& after);

  /// Submits what is recorded so far, waits for it and goes on recording; constants() stay valid. For passes whose
  /// next step on the host needs a result: of generation, and of an update that makes something of unknown size. The
  /// time counts; draws never wait.
  void submitAndWait();

  // For the harness: one submission per frame.
  void begin();        ///< waits for this slot's earlier submission; drops what was not submitted
  void submit();       ///< ends and submits with a fence; all writes are made visible to the host
  void wait();         ///< until that submission has finished; throws DeviceError after kGpuTimeout
  void clearUploads(); ///< frees oversized staging memory of a generation; not while recording or pending

private:
  struct Implementation;
  Device& m_device;
  std::unique_ptr<Implementation> m_implementation;
};

/// Bytes of one trivially copyable push-constant block.
template <class T> std::span<const std::byte> bytesOf(const T& value) {
  return std::as_bytes(std::span<const T, 1>(&value, 1));
}

} // namespace volmark::gpu
