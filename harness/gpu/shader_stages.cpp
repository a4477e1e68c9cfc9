#include "gpu/shader_stages.h"

#include "volmark/error.h"

#include <fmt/format.h>

namespace volmark::gpu {

namespace {

void requireStage(const Device& device, const ShaderSource& source) {
  const bool isMesh = source.stage & (VK_SHADER_STAGE_TASK_BIT_EXT | VK_SHADER_STAGE_MESH_BIT_EXT);
  if (isMesh && !device.facts().meshShader)
    throw UnsupportedError(fmt::format("{}: the device {} has no mesh shaders", source.path, device.facts().name));
}

void requireSubgroupSize(const Device& device, std::uint32_t size) {
  const DeviceFacts& facts = device.facts();
  if (size == 0 ||
      (facts.subgroupSizeControl && size >= facts.minimumSubgroupSize && size <= facts.maximumSubgroupSize))
    return;
  throw UnsupportedError(fmt::format("a subgroup size of {} is required, the device {} offers {} to {}", size,
                                     facts.name, facts.minimumSubgroupSize, facts.maximumSubgroupSize));
}

} // namespace

ShaderStages::ShaderStages(Device& device, std::span<const ShaderSource> sources, const Specialisation& specialisation,
                           std::uint32_t requiredSubgroupSize)
    : m_device(device), m_specialisation{static_cast<std::uint32_t>(specialisation.entries().size()),
                                         specialisation.entries().data(),
                                         specialisation.data().size() * sizeof(std::uint32_t),
                                         specialisation.data().data()} {
  requireSubgroupSize(device, requiredSubgroupSize);
  for (const ShaderSource& source : sources)
    requireStage(device, source);
  try {
    for (const ShaderSource& source : sources)
      add(source, requiredSubgroupSize);
  } catch (const std::exception&) {
    destroy();
    throw;
  }
}

void ShaderStages::add(const ShaderSource& source, std::uint32_t requiredSubgroupSize) {
  const std::vector<std::uint32_t> words = compileShader(source);
  VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  info.codeSize = words.size() * sizeof(std::uint32_t);
  info.pCode = words.data();
  VkPipelineShaderStageCreateInfo stage{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  stage.stage = source.stage;
  stage.pName = "main";
  stage.pSpecializationInfo = &m_specialisation;
  check(vkCreateShaderModule(m_device.handle(), &info, nullptr, &stage.module), "vkCreateShaderModule");
  m_device.setName(VK_OBJECT_TYPE_SHADER_MODULE, reinterpret_cast<std::uint64_t>(stage.module), source.path);
  if (requiredSubgroupSize > 0) {
    m_subgroup.requiredSubgroupSize = requiredSubgroupSize;
    stage.pNext = &m_subgroup;
  }
  m_infos.push_back(stage);
}

ShaderStages::~ShaderStages() {
  destroy();
}

void ShaderStages::destroy() noexcept {
  for (const VkPipelineShaderStageCreateInfo& stage : m_infos)
    vkDestroyShaderModule(m_device.handle(), stage.module, nullptr);
}

} // namespace volmark::gpu
