// A render pass of rasterising techniques.
#pragma once

#include "volmark/gpu/commands.h"
#include "volmark/gpu/image.h"

#include <glm/glm.hpp>

#include <vector>

namespace volmark::gpu {

/// One image that is drawn to, in VK_IMAGE_LAYOUT_GENERAL.
struct Attachment {
  VkImageView view = VK_NULL_HANDLE;
  bool clear = false; ///< to `value` (depth: its x) at the beginning; what it holds is loaded otherwise
  glm::vec4 value{0};
};

struct RenderingDescription {
  glm::ivec2 size{0};
  std::uint32_t layers = 1;   ///< of the attachments' views, chosen by gl_Layer
  std::uint32_t viewMask = 0; ///< multiview instead: a bit for each layer
  std::vector<Attachment> colors;
  Attachment depth; ///< without a view: none
};

/// Open as long as it lives; draw inside, dispatch and synchronise outside. Viewport and scissor cover the size.
class Rendering {
public:
  Rendering(Commands& commands, const RenderingDescription& description);
  ~Rendering();
  Rendering(const Rendering&) = delete;
  Rendering& operator=(const Rendering&) = delete;

private:
  Commands& m_commands;
};

/// What draws write, between passes.
inline constexpr Use kDrawWrite{
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT |
        VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT |
        VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT};

} // namespace volmark::gpu
