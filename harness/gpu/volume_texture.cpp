#include "volmark/gpu/volume_texture.h"

#include "volmark/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstddef>

namespace volmark::gpu {

namespace {

constexpr std::size_t kSlabBytes = std::size_t(64) << 20; // bounds the staging memory of an upload

VkFormat formatOf(ScalarType type) {
  switch (type) {
  case ScalarType::int8:
  case ScalarType::uint8: return VK_FORMAT_R8_UNORM;
  case ScalarType::int16:
  case ScalarType::uint16: return VK_FORMAT_R16_UNORM;
  case ScalarType::float32: return VK_FORMAT_R32_SFLOAT;
  }
  return VK_FORMAT_UNDEFINED;
}

/// The raw value is factor * sampled + offset.
struct Decoding {
  double factor;
  double offset;
};

Decoding decodingOf(ScalarType type) {
  switch (type) {
  case ScalarType::int8: return {255, -128};
  case ScalarType::uint8: return {255, 0};
  case ScalarType::int16: return {65535, -32768};
  case ScalarType::uint16: return {65535, 0};
  case ScalarType::float32: return {1, 0};
  }
  return {1, 0};
}

/// Flips the sign bits of signed integers: two's complement becomes offset binary.
void flipSigns(ScalarType type, std::span<std::byte> bytes) {
  const std::size_t size = sizeOf(type); // little endian: the last byte of a number holds its sign
  for (std::size_t i = size - 1; i < bytes.size(); i += size)
    bytes[i] ^= std::byte{0x80};
}

bool isSigned(ScalarType type) {
  return type == ScalarType::int8 || type == ScalarType::int16;
}

/// Records slices [first, first+count) of one time step.
void recordSlab(Commands& commands, const Image& image, const Volume& volume, int step, std::size_t first,
                std::size_t count) {
  const glm::ivec3 dims = volume.grid().dims;
  const std::size_t sliceBytes =
      static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) * sizeOf(volume.type());
  const auto bytes = volume.voxels(step).subspan(first * sliceBytes, count * sliceBytes);
  if (!isSigned(volume.type())) {
    commands.uploadSlab(image, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count), bytes);
    return;
  }
  std::vector<std::byte> flipped(bytes.begin(), bytes.end());
  flipSigns(volume.type(), flipped);
  commands.uploadSlab(image, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count), flipped);
}

void beginUpload(Commands& commands, const Image& image) {
  commands.transition(image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, kAnything,
                      kTransferWrite);
}

void endUpload(Commands& commands, const Image& image) {
  commands.transition(image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                      kTransferWrite, {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_SHADER_READ_BIT});
}

ImageDescription describe(const Volume& volume) {
  const glm::uvec3 dims(volume.grid().dims);
  ImageDescription description;
  description.name = "volume texture";
  description.type = VK_IMAGE_TYPE_3D;
  description.format = formatOf(volume.type());
  description.extent = {dims.x, dims.y, dims.z};
  description.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  return description;
}

} // namespace

std::optional<std::string> VolumeTexture::whyUnsupported(const Device& device, const Volume& volume,
                                                         Filtering filtering) {
  const VkFormat format = formatOf(volume.type());
  const std::uint32_t most = device.facts().maximumImageDimension3D;
  const glm::ivec3 dims = volume.grid().dims;
  const std::uint64_t bytes = volume.grid().voxelCount() * sizeOf(volume.type());
  if (static_cast<std::uint32_t>(std::max({dims.x, dims.y, dims.z})) > most)
    return fmt::format("the volume has {} x {} x {} voxels, the device's 3-D images hold at most {} along an axis",
                       dims.x, dims.y, dims.z, most);
  if (bytes > device.facts().maximumAllocationBytes)
    return fmt::format("a time step of the volume has {} bytes, the device allows {} at once", bytes,
                       device.facts().maximumAllocationBytes);
  if (!device.supports(format, VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_TRANSFER_DST_BIT))
    return fmt::format("the device can't sample images of {}", nameOf(volume.type()));
  if (filtering == Filtering::hardware && !device.filtersLinearly(format))
    return fmt::format("the device can't filter images of {} linearly", nameOf(volume.type()));
  return std::nullopt;
}

VolumeTexture::VolumeTexture(Device& device, const Scene& scene, Filtering filtering, Recorder& recorder, int first,
                             int count)
    : m_filtering(filtering), m_first(first),
      m_sampler(device, filtering == Filtering::hardware ? VK_FILTER_LINEAR : VK_FILTER_NEAREST) {
  const Volume& volume = *scene.volume;
  assert(first >= 0 && count >= 1 && first + count <= volume.timeSteps());
  if (const auto why = whyUnsupported(device, volume, filtering)) throw UnsupportedError(*why);
  const Decoding decoding = decodingOf(volume.type());
  const double width = scene.visualisationRange.maximum - scene.visualisationRange.minimum;
  m_scale = static_cast<float>(decoding.factor / width);
  m_bias = static_cast<float>((decoding.offset - scene.visualisationRange.minimum) / width);
  for (int slot = 0; slot < count; ++slot)
    m_images.emplace_back(device, describe(volume));
  const Pass pass = recorder.pass("upload");
  for (int slot = 0; slot < count; ++slot)
    uploadInSlabs(recorder.gpu(), volume, first + slot, slot);
}

void VolumeTexture::uploadInSlabs(Commands& commands, const Volume& volume, int step, int slot) {
  const Image& image = m_images[static_cast<std::size_t>(slot)];
  const std::size_t depth = image.description().extent.depth;
  const std::size_t sliceBytes = volume.voxels(step).size() / depth;
  const std::size_t slices = std::clamp<std::size_t>(kSlabBytes / sliceBytes, 1, depth);
  beginUpload(commands, image);
  for (std::size_t z = 0; z < depth; z += slices) {
    recordSlab(commands, image, volume, step, z, std::min(slices, depth - z));
    // Frees the staging memory for the next slab; small volumes stay in one submission.
    if (slices < depth) commands.submitAndWait();
  }
  endUpload(commands, image);
}

SampledImage VolumeTexture::slot(int index) const {
  return {m_images.at(static_cast<std::size_t>(index)).view(), m_sampler.handle()};
}

void VolumeTexture::upload(Commands& commands, const Volume& volume, int step, int slot) {
  const Image& image = m_images.at(static_cast<std::size_t>(slot));
  beginUpload(commands, image);
  recordSlab(commands, image, volume, step, 0, image.description().extent.depth);
  endUpload(commands, image);
}

VkDeviceSize VolumeTexture::bytes() const {
  VkDeviceSize total = 0;
  for (const Image& image : m_images)
    total += image.memory().bytes;
  return total;
}

} // namespace volmark::gpu
