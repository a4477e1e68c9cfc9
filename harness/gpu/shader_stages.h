// Shader modules and stage descriptions of a pipeline under construction.
#pragma once

#include "volmark/gpu/pipeline.h"

#include <span>
#include <vector>

namespace volmark::gpu {

/// Owns the modules until the pipeline has been made.
class ShaderStages {
public:
  /// Compiles all sources. `requiredSubgroupSize` 0: the driver's choice. `specialisation` must stay alive.
  ShaderStages(Device& device, std::span<const ShaderSource> sources, const Specialisation& specialisation,
               std::uint32_t requiredSubgroupSize);
  ~ShaderStages();
  ShaderStages(const ShaderStages&) = delete;
  ShaderStages& operator=(const ShaderStages&) = delete;

  const std::vector<VkPipelineShaderStageCreateInfo>& infos() const { return m_infos; }

private:
  void add(const ShaderSource& source, std::uint32_t requiredSubgroupSize);
  void destroy() noexcept;

  Device& m_device;
  VkSpecializationInfo m_specialisation;
  VkPipelineShaderStageRequiredSubgroupSizeCreateInfo m_subgroup{
      VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_REQUIRED_SUBGROUP_SIZE_CREATE_INFO};
  std::vector<VkPipelineShaderStageCreateInfo> m_infos;
};

} // namespace volmark::gpu
