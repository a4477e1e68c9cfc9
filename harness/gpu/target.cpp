#include "volmark/gpu/target.h"

#include <glm/gtc/packing.hpp>

#include <cassert>
#include <cstring>

namespace volmark::gpu {

namespace {

constexpr VkImageUsageFlags kUsage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                     VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                                     VK_IMAGE_USAGE_SAMPLED_BIT;

ImageDescription layered(const char* name, VkFormat format, int width, int height, int views) {
  ImageDescription description;
  description.name = name;
  description.format = format;
  description.extent = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), 1};
  description.layers = static_cast<std::uint32_t>(views);
  description.usage = kUsage;
  return description;
}

Buffer readbackBuffer(Device& device, VkDeviceSize bytes) {
  return Buffer(device, {"", bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryAccess::readback});
}

void recordCopy(Commands& commands, const Image& image, int layer, const Buffer& buffer) {
  commands.transition(image, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, kAnything, kTransferRead);
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, static_cast<std::uint32_t>(layer), 1};
  region.imageExtent = image.description().extent;
  vkCmdCopyImageToBuffer(commands.handle(), image.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer.handle(), 1,
                         &region);
  commands.transition(image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_GENERAL, kTransferRead, kAnything);
}

/// The texels of one layer.
template <class Texel> std::vector<Texel> readAll(Device& device, const Image& image, int layer, std::size_t pixels) {
  const Buffer buffer = readbackBuffer(device, pixels * sizeof(Texel));
  Commands commands(device);
  commands.begin();
  recordCopy(commands, image, layer, buffer);
  commands.barrier(kTransferWrite, kHostRead);
  commands.submit();
  commands.wait();
  std::vector<Texel> texels(pixels);
  std::memcpy(texels.data(), buffer.mapped().data(), pixels * sizeof(Texel));
  return texels;
}

} // namespace

Target::Target(Device& device, int width_, int height_, int views_, const std::vector<PictureLayer>& layers)
    : width(width_), height(height_), views(views_),
      color(device, layered("target colour", kColorFormat, width, height, views)),
      distance(device, layered("target distance", kDepthFormat, width, height, views)) {
  for (const PictureLayer layer : layers) {
    if (layer == PictureLayer::normal)
      normal = Image(device, layered("target normal", kNormalFormat, width, height, views));
    if (layer == PictureLayer::steps)
      steps = Image(device, layered("target steps", kStepsFormat, width, height, views));
  }
}

void Target::initialise(Commands& commands) const {
  for (const Image* image : {&color, &distance, &normal, &steps})
    if (*image) commands.transition(*image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL, kAnything, kAnything);
}

Picture readBack(Device& device, const Target& target, int view) {
  assert(view >= 0 && view < target.views);
  Picture picture(target.width, target.height);
  const std::size_t pixels = picture.color.size();
  const auto colors = readAll<std::uint64_t>(device, target.color, view, pixels);
  for (std::size_t i = 0; i < pixels; ++i)
    picture.color[i] = glm::unpackHalf4x16(colors[i]);
  picture.distance = readAll<float>(device, target.distance, view, pixels);
  return picture;
}

void readBackLayers(Device& device, const Target& target, int view, Picture& picture) {
  assert(view >= 0 && view < target.views);
  const std::size_t pixels = picture.color.size();
  if (target.normal) {
    const std::vector<glm::vec4> normals = readAll<glm::vec4>(device, target.normal, view, pixels);
    picture.normal.assign(normals.begin(), normals.end());
  }
  if (target.steps) picture.steps = readAll<float>(device, target.steps, view, pixels);
}

} // namespace volmark::gpu
