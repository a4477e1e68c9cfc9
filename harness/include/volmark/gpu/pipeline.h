// Pipelines. Resources are bound by push descriptors in set 0; binding i of the list is `binding = i` in GLSL.
#pragma once

#include "volmark/gpu/device.h"
#include "volmark/gpu/shader.h"

#include <cstdint>
#include <string>
#include <vector>

namespace volmark::gpu {

/// Values of specialisation constants by constant_id, for all stages of a pipeline.
class Specialisation {
public:
  Specialisation& set(std::uint32_t id, std::uint32_t value);
  Specialisation& set(std::uint32_t id, std::int32_t value);
  Specialisation& set(std::uint32_t id, float value);
  Specialisation& set(std::uint32_t id, bool value);

  const std::vector<VkSpecializationMapEntry>& entries() const { return m_entries; }
  const std::vector<std::uint32_t>& data() const { return m_data; }

private:
  std::vector<VkSpecializationMapEntry> m_entries;
  std::vector<std::uint32_t> m_data;
};

struct PipelineLayoutDescription {
  std::vector<VkDescriptorType> bindings; ///< binding i has type bindings[i], count 1, all stages
  std::uint32_t pushConstantBytes = 0;    ///< at most 128
};

struct ComputePipelineDescription {
  std::string name;
  ShaderSource shader;
  PipelineLayoutDescription layout;
  Specialisation specialisation;
  std::uint32_t requiredSubgroupSize = 0; ///< 0: the driver's choice
};

enum class Blending { none, premultiplied };

struct GraphicsPipelineDescription {
  std::string name;
  std::vector<ShaderSource> shaders; ///< vertex+fragment or [task+]mesh+fragment
  PipelineLayoutDescription layout;
  Specialisation specialisation;
  std::vector<VkFormat> colorFormats;
  VkFormat depthFormat = VK_FORMAT_UNDEFINED; ///< undefined: no depth test
  VkCompareOp depthCompare = VK_COMPARE_OP_LESS;
  bool depthWrite = true;
  VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkCullModeFlags cullMode = VK_CULL_MODE_NONE;
  VkFrontFace frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
  bool alphaToCoverage = false;
  Blending blending = Blending::none;
  std::uint32_t viewMask = 0; ///< multiview; vertex pipelines only
  /// Where the device has it: of each primitive at least one fragment that passes is shaded, and the rest may be left
  /// out.
  bool representativeFragmentTest = false;
};

/// Move-only owner of a pipeline and its layout. Viewport and scissor are dynamic in graphics pipelines.
/// Compilation errors throw InputError, unsupported stages UnsupportedError.
class Pipeline {
public:
  Pipeline() = default;
  Pipeline(Device& device, const ComputePipelineDescription& description);
  Pipeline(Device& device, const GraphicsPipelineDescription& description);
  ~Pipeline();
  Pipeline(Pipeline&& other) noexcept;
  Pipeline& operator=(Pipeline&& other) noexcept;

  VkPipeline handle() const { return m_handle; }
  VkPipelineLayout layout() const { return m_layout; }
  VkPipelineBindPoint bindPoint() const { return m_bindPoint; }
  VkShaderStageFlags stages() const { return m_stages; } ///< that see bindings and push constants
  const std::string& name() const { return m_name; }
  const PipelineLayoutDescription& layoutDescription() const { return m_layoutDescription; }
  explicit operator bool() const { return m_handle != VK_NULL_HANDLE; }

private:
  void createLayout(const PipelineLayoutDescription& description);
  void createCompute(const ComputePipelineDescription& description);
  void createGraphics(const GraphicsPipelineDescription& description);
  void destroy() noexcept;

  Device* m_device = nullptr;
  std::string m_name;
  VkPipeline m_handle = VK_NULL_HANDLE;
  VkPipelineLayout m_layout = VK_NULL_HANDLE;
  VkDescriptorSetLayout m_setLayout = VK_NULL_HANDLE;
  VkPipelineBindPoint m_bindPoint = VK_PIPELINE_BIND_POINT_COMPUTE;
  VkShaderStageFlags m_stages = VK_SHADER_STAGE_COMPUTE_BIT;
  PipelineLayoutDescription m_layoutDescription;
};

} // namespace volmark::gpu
