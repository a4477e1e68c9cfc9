#include "gpu_test.h"
#include "volmark/gpu/counter_buffer.h"

#include <numeric>
#include <stdexcept>

namespace volmark::gpu::test {

namespace {

using CommandsTest = GpuTest;

std::vector<std::uint32_t> numbersFrom(std::uint32_t first, std::size_t count) {
  std::vector<std::uint32_t> values(count);
  std::iota(values.begin(), values.end(), first);
  return values;
}

std::vector<std::uint32_t> wordsOf(const Buffer& buffer) {
  std::vector<std::uint32_t> words(buffer.bytes() / sizeof(std::uint32_t));
  std::memcpy(words.data(), buffer.mapped().data(), buffer.bytes());
  return words;
}

Buffer readback(Device& device, std::size_t words) {
  return Buffer(device, {"readback", words * 4, VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                         MemoryAccess::readback});
}

void copy(Commands& commands, const Buffer& from, const Buffer& to) {
  const VkBufferCopy region{0, 0, from.bytes()};
  vkCmdCopyBuffer(commands.handle(), from.handle(), to.handle(), 1, &region);
}

/// result[i] = input word, copied by a shader.
Pipeline copyPipeline(Device& device, VkDescriptorType type) {
  const bool isUniform = type == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
  const std::string shader =
      addShader(isUniform ? "copy_uniform.comp.glsl" : "copy_storage.comp.glsl",
                std::string("#version 460\n#extension GL_EXT_scalar_block_layout : require\n"
                            "layout(local_size_x = 1) in;\n"
                            "layout(binding = 0, scalar) buffer To { uint to[]; };\n"
                            "layout(push_constant) uniform Push { uint place; };\n") +
                    (isUniform ? "layout(binding = 1, scalar) uniform From { uint from; };\n"
                               : "layout(binding = 1, scalar) readonly buffer From { uint from; };\n") +
                    "void main() { to[place] = from; }\n");
  return Pipeline(device, ComputePipelineDescription{"copy", {shader}, {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, type}, 4}});
}

} // namespace

TEST_F(CommandsTest, BufferContentsComeBack) {
  const auto words = numbersFrom(7, 100000);
  const Buffer onDevice(
      device(), {"numbers", words.size() * 4, VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT});
  const Buffer back = readback(device(), words.size());
  Commands commands(device());
  commands.begin();
  commands.upload(onDevice, 0, std::as_bytes(std::span(words)));
  commands.barrier(kTransferWrite, kTransferWrite);
  const std::uint32_t patch[] = {1, 2, 3};
  commands.upload(onDevice, 40, std::as_bytes(std::span(patch)));
  commands.barrier(kTransferWrite, kTransferRead);
  copy(commands, onDevice, back);
  commands.submit();
  commands.wait();
  auto expected = words;
  std::copy(std::begin(patch), std::end(patch), expected.begin() + 10);
  EXPECT_EQ(wordsOf(back), expected);
}

TEST_F(CommandsTest, ImageContentsComeBack) {
  ImageDescription description;
  description.name = "voxels";
  description.type = VK_IMAGE_TYPE_3D;
  description.format = VK_FORMAT_R32_UINT;
  description.extent = {5, 3, 7};
  description.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  const Image image(device(), description);
  const auto words = numbersFrom(1, 5 * 3 * 7);
  const Buffer back = readback(device(), words.size());
  Commands commands(device());
  commands.begin();
  commands.upload(image, std::as_bytes(std::span(words)));
  commands.transition(image, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, kAnything,
                      kTransferRead);
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = description.extent;
  vkCmdCopyImageToBuffer(commands.handle(), image.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, back.handle(), 1,
                         &region);
  commands.submit();
  commands.wait();
  EXPECT_EQ(wordsOf(back), words);
}

TEST_F(CommandsTest, ConstantsKeepTheirValuesThroughAFrame) {
  // More of them than one block of memory holds, and with a submission in between.
  const auto uniform = copyPipeline(device(), VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER);
  const auto storage = copyPipeline(device(), VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
  constexpr std::uint32_t count = 40;
  const Buffer back = readback(device(), count);
  Commands commands(device());
  for (std::uint32_t frame = 0; frame < 2; ++frame) {
    commands.begin();
    std::vector<BufferRange> ranges;
    for (std::uint32_t i = 0; i < count; ++i) {
      std::vector<std::uint32_t> block(10000, 1000 * frame + i);
      ranges.push_back(commands.constants(std::as_bytes(std::span(block))));
    }
    for (std::uint32_t i = 0; i < count; ++i) {
      if (i == count / 2) commands.submitAndWait();
      const Resource resources[] = {back.range(), ranges[i]};
      commands.dispatch(i % 2 ? uniform : storage, resources, bytesOf(i), {1, 1, 1});
    }
    commands.submit();
    commands.wait();
    EXPECT_EQ(wordsOf(back), numbersFrom(1000 * frame, count));
  }
  commands.clearUploads();
}

TEST_F(CommandsTest, BeginDropsWhatWasNotSubmitted) {
  // What is left of a pass that threw.
  const Pipeline pipeline = copyPipeline(device(), VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER);
  const Buffer back = readback(device(), 2);
  std::memset(back.mapped().data(), 0, 8);
  Commands commands(device());
  for (std::uint32_t place = 0; place < 2; ++place) {
    commands.begin();
    const Resource resources[] = {back.range(), commands.constants(std::uint32_t(9))};
    commands.dispatch(pipeline, resources, bytesOf(place), {1, 1, 1});
  }
  commands.submit();
  commands.wait();
  EXPECT_EQ(wordsOf(back), (std::vector<std::uint32_t>{0, 9}));
}

TEST_F(CommandsTest, DispatchesIndirectly) {
  const Pipeline pipeline = copyPipeline(device(), VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER);
  const Buffer arguments(device(), {"arguments", 24, VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT, MemoryAccess::upload});
  const std::uint32_t groups[] = {0, 0, 0, 1, 1, 1};
  std::memcpy(arguments.mapped().data(), groups, sizeof groups);
  const Buffer back = readback(device(), 2);
  Commands commands(device());
  commands.begin();
  commands.fill(back, 5);
  commands.barrier(kTransferWrite, kComputeWrite);
  for (std::uint32_t place = 0; place < 2; ++place) {
    const Resource resources[] = {back.range(), commands.constants(std::uint32_t(9))};
    commands.dispatchIndirect(pipeline, resources, bytesOf(place), {arguments.handle(), 12 * place, 12});
  }
  commands.submit();
  commands.wait();
  EXPECT_EQ(wordsOf(back), (std::vector<std::uint32_t>{5, 9}));
}

TEST_F(CommandsTest, ResourcesThatDoNotFitTheLayoutAreRefused) {
  const Pipeline pipeline = copyPipeline(device(), VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER);
  const Buffer back = readback(device(), 1);
  Commands commands(device());
  commands.begin();
  const std::uint32_t push = 0;
  const Resource tooFew[] = {back.range()};
  const Resource wrongKind[] = {back.range(), StorageImage{}};
  const Resource right[] = {back.range(), back.range()};
  EXPECT_THROW(commands.bind(pipeline, tooFew, bytesOf(push)), std::logic_error);
  EXPECT_THROW(commands.bind(pipeline, wrongKind, bytesOf(push)), std::logic_error);
  EXPECT_THROW(commands.bind(pipeline, right, {}), std::logic_error);
  commands.submit();
}

TEST_F(CommandsTest, CountersCarryInto64Bits) {
  const CounterBuffer counters(device(), 3);
  const std::string shader =
      addShader("counters.comp.glsl", "#version 460\n#include <volmark/counters.glsl>\n"
                                      "VOLMARK_COUNTERS(0)\n"
                                      "layout(local_size_x = 32) in;\n"
                                      "void main() {\n"
                                      "  addToCounter(0u, 0x60000001u);\n"
                                      "  addToCounterBySubgroup(2u, 1000u + gl_LocalInvocationIndex);\n"
                                      "}\n");
  const Pipeline pipeline(device(),
                          ComputePipelineDescription{"counters", {shader}, {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER}}});
  Commands commands(device());
  for (int frame = 0; frame < 2; ++frame) {
    commands.begin();
    counters.clear(commands);
    const Resource resources[] = {counters.range()};
    commands.dispatch(pipeline, resources, {}, {10, 1, 1});
    commands.submit();
    commands.wait();
    EXPECT_EQ(counters.read(), (std::vector<std::uint64_t>{320ull * 0x60000001ull, 0, 10 * (32 * 1000 + 31 * 16)}));
  }
}

} // namespace volmark::gpu::test
