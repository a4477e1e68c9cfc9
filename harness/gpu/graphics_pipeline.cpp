// The fixed-function states of a graphics pipeline.
#include "gpu/shader_stages.h"
#include "volmark/error.h"

#include <fmt/format.h>

namespace volmark::gpu {

namespace {

constexpr VkColorComponentFlags kAllComponents =
    VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;

/// Premultiplied "over" into float targets; formats that can't blend (R32F on some devices) keep writing.
std::vector<VkPipelineColorBlendAttachmentState> blendStates(const Device& device,
                                                             const GraphicsPipelineDescription& description) {
  std::vector<VkPipelineColorBlendAttachmentState> states;
  for (const VkFormat format : description.colorFormats) {
    VkPipelineColorBlendAttachmentState state{};
    state.colorWriteMask = kAllComponents;
    state.blendEnable = description.blending == Blending::premultiplied &&
                        device.supports(format, VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT);
    state.srcColorBlendFactor = state.srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
    state.dstColorBlendFactor = state.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
    state.colorBlendOp = state.alphaBlendOp = VK_BLEND_OP_ADD;
    states.push_back(state);
  }
  return states;
}

VkPipelineRasterizationStateCreateInfo rasterisation(const GraphicsPipelineDescription& description) {
  VkPipelineRasterizationStateCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  info.polygonMode = VK_POLYGON_MODE_FILL;
  info.cullMode = description.cullMode;
  info.frontFace = description.frontFace;
  info.lineWidth = 1;
  return info;
}

VkPipelineMultisampleStateCreateInfo multisampling(const GraphicsPipelineDescription& description) {
  VkPipelineMultisampleStateCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  info.rasterizationSamples = description.samples;
  info.alphaToCoverageEnable = description.alphaToCoverage;
  return info;
}

VkPipelineDepthStencilStateCreateInfo depthTest(const GraphicsPipelineDescription& description) {
  VkPipelineDepthStencilStateCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  info.depthTestEnable = description.depthFormat != VK_FORMAT_UNDEFINED;
  info.depthWriteEnable = info.depthTestEnable && description.depthWrite;
  info.depthCompareOp = description.depthCompare;
  return info;
}

void requireMultiview(const Device& device, const GraphicsPipelineDescription& description) {
  if (description.viewMask != 0 && !device.facts().multiview)
    throw UnsupportedError(fmt::format("{}: the device {} has no multiview", description.name, device.facts().name));
}

} // namespace

void Pipeline::createGraphics(const GraphicsPipelineDescription& description) {
  requireMultiview(*m_device, description);
  const ShaderStages stages(*m_device, description.shaders, description.specialisation, 0);
  createLayout(description.layout);

  const VkPipelineVertexInputStateCreateInfo vertices{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = description.topology;
  VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  viewport.viewportCount = viewport.scissorCount = 1;
  const auto raster = rasterisation(description);
  const auto samples = multisampling(description);
  const auto depth = depthTest(description);
  const auto blends = blendStates(*m_device, description);
  VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blend.attachmentCount = static_cast<std::uint32_t>(blends.size());
  blend.pAttachments = blends.data();
  const VkDynamicState dynamicStates[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
  dynamic.dynamicStateCount = 2;
  dynamic.pDynamicStates = dynamicStates;
  VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
  rendering.viewMask = description.viewMask;
  rendering.colorAttachmentCount = static_cast<std::uint32_t>(description.colorFormats.size());
  rendering.pColorAttachmentFormats = description.colorFormats.data();
  rendering.depthAttachmentFormat = description.depthFormat;

  VkPipelineRepresentativeFragmentTestStateCreateInfoNV representative{
      VK_STRUCTURE_TYPE_PIPELINE_REPRESENTATIVE_FRAGMENT_TEST_STATE_CREATE_INFO_NV};
  representative.representativeFragmentTestEnable = VK_TRUE;
  if (description.representativeFragmentTest && m_device->facts().representativeFragmentTest)
    rendering.pNext = &representative;

  VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, &rendering};
  info.stageCount = static_cast<std::uint32_t>(stages.infos().size());
  info.pStages = stages.infos().data();
  info.pVertexInputState = &vertices;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = m_layout;
  check(vkCreateGraphicsPipelines(m_device->handle(), VK_NULL_HANDLE, 1, &info, nullptr, &m_handle),
        "vkCreateGraphicsPipelines");
  m_device->setName(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(m_handle), m_name);
}

} // namespace volmark::gpu
