#include "volmark/gpu/pipeline.h"

#include "gpu/shader_stages.h"

#include <bit>
#include <cassert>
#include <utility>

namespace volmark::gpu {

Specialisation& Specialisation::set(std::uint32_t id, std::uint32_t value) {
  m_entries.push_back({id, static_cast<std::uint32_t>(m_data.size() * sizeof(std::uint32_t)), sizeof(std::uint32_t)});
  m_data.push_back(value);
  return *this;
}

Specialisation& Specialisation::set(std::uint32_t id, std::int32_t value) {
  return set(id, std::bit_cast<std::uint32_t>(value));
}

Specialisation& Specialisation::set(std::uint32_t id, float value) {
  return set(id, std::bit_cast<std::uint32_t>(value));
}

Specialisation& Specialisation::set(std::uint32_t id, bool value) {
  return set(id, static_cast<std::uint32_t>(value));
}

Pipeline::Pipeline(Device& device, const ComputePipelineDescription& description)
    : m_device(&device), m_name(description.name) {
  try {
    createCompute(description);
  } catch (const std::exception&) {
    destroy();
    throw;
  }
}

Pipeline::Pipeline(Device& device, const GraphicsPipelineDescription& description)
    : m_device(&device), m_name(description.name), m_bindPoint(VK_PIPELINE_BIND_POINT_GRAPHICS),
      m_stages(VK_SHADER_STAGE_ALL_GRAPHICS) {
  if (device.facts().meshShader) m_stages |= VK_SHADER_STAGE_TASK_BIT_EXT | VK_SHADER_STAGE_MESH_BIT_EXT;
  try {
    createGraphics(description);
  } catch (const std::exception&) {
    destroy();
    throw;
  }
}

void Pipeline::createLayout(const PipelineLayoutDescription& description) {
  assert(description.pushConstantBytes <= 128 && description.pushConstantBytes % 4 == 0);
  m_layoutDescription = description;
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const VkDescriptorType type : description.bindings)
    bindings.push_back({static_cast<std::uint32_t>(bindings.size()), type, 1, m_stages, nullptr});
  VkDescriptorSetLayoutCreateInfo setInfo{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  setInfo.flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR;
  setInfo.bindingCount = static_cast<std::uint32_t>(bindings.size());
  setInfo.pBindings = bindings.data();
  check(vkCreateDescriptorSetLayout(m_device->handle(), &setInfo, nullptr, &m_setLayout),
        "vkCreateDescriptorSetLayout");

  const VkPushConstantRange push{m_stages, 0, description.pushConstantBytes};
  VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  info.setLayoutCount = 1;
  info.pSetLayouts = &m_setLayout;
  info.pushConstantRangeCount = description.pushConstantBytes > 0 ? 1 : 0;
  info.pPushConstantRanges = &push;
  check(vkCreatePipelineLayout(m_device->handle(), &info, nullptr, &m_layout), "vkCreatePipelineLayout");
}

void Pipeline::createCompute(const ComputePipelineDescription& description) {
  assert(description.shader.stage == VK_SHADER_STAGE_COMPUTE_BIT);
  const ShaderStages stages(*m_device, std::span(&description.shader, 1), description.specialisation,
                            description.requiredSubgroupSize);
  createLayout(description.layout);
  VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  info.stage = stages.infos().front();
  info.layout = m_layout;
  check(vkCreateComputePipelines(m_device->handle(), VK_NULL_HANDLE, 1, &info, nullptr, &m_handle),
        "vkCreateComputePipelines");
  m_device->setName(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(m_handle), m_name);
}

Pipeline::~Pipeline() {
  destroy();
}

Pipeline::Pipeline(Pipeline&& other) noexcept {
  *this = std::move(other);
}

Pipeline& Pipeline::operator=(Pipeline&& other) noexcept {
  if (this == &other) return *this;
  destroy();
  m_device = std::exchange(other.m_device, nullptr);
  m_name = std::exchange(other.m_name, {});
  m_handle = std::exchange(other.m_handle, VK_NULL_HANDLE);
  m_layout = std::exchange(other.m_layout, VK_NULL_HANDLE);
  m_setLayout = std::exchange(other.m_setLayout, VK_NULL_HANDLE);
  m_bindPoint = other.m_bindPoint;
  m_stages = other.m_stages;
  m_layoutDescription = std::exchange(other.m_layoutDescription, {});
  return *this;
}

void Pipeline::destroy() noexcept {
  if (!m_device) return;
  const VkDevice device = m_device->handle();
  if (m_handle) vkDestroyPipeline(device, m_handle, nullptr);
  if (m_layout) vkDestroyPipelineLayout(device, m_layout, nullptr);
  if (m_setLayout) vkDestroyDescriptorSetLayout(device, m_setLayout, nullptr);
  m_handle = VK_NULL_HANDLE;
  m_layout = VK_NULL_HANDLE;
  m_setLayout = VK_NULL_HANDLE;
  m_device = nullptr;
}

} // namespace volmark::gpu
