#include "volmark/gpu/rendering.h"

namespace volmark::gpu {

namespace {

VkRenderingAttachmentInfo infoOf(const Attachment& attachment, bool isDepth) {
  VkRenderingAttachmentInfo info{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  info.imageView = attachment.view;
  info.imageLayout = VK_IMAGE_LAYOUT_GENERAL;
  info.loadOp = attachment.clear ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD;
  info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  const glm::vec4& value = attachment.value;
  if (isDepth)
    info.clearValue.depthStencil = {value.x, 0};
  else
    info.clearValue.color = {{value.x, value.y, value.z, value.w}};
  return info;
}

} // namespace

Rendering::Rendering(Commands& commands, const RenderingDescription& description) : m_commands(commands) {
  std::vector<VkRenderingAttachmentInfo> colors;
  for (const Attachment& attachment : description.colors)
    colors.push_back(infoOf(attachment, false));
  const VkRenderingAttachmentInfo depth = infoOf(description.depth, true);
  VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
  info.renderArea.extent = {static_cast<std::uint32_t>(description.size.x),
                            static_cast<std::uint32_t>(description.size.y)};
  info.layerCount = description.viewMask == 0 ? description.layers : 1;
  info.viewMask = description.viewMask;
  info.colorAttachmentCount = static_cast<std::uint32_t>(colors.size());
  info.pColorAttachments = colors.data();
  if (description.depth.view != VK_NULL_HANDLE) info.pDepthAttachment = &depth;
  vkCmdBeginRendering(commands.handle(), &info);
  const VkViewport viewport{0, 0, static_cast<float>(description.size.x), static_cast<float>(description.size.y), 0, 1};
  vkCmdSetViewport(commands.handle(), 0, 1, &viewport);
  vkCmdSetScissor(commands.handle(), 0, 1, &info.renderArea);
}

Rendering::~Rendering() {
  vkCmdEndRendering(m_commands.handle());
}

} // namespace volmark::gpu
