#include "gpu_test.h"
#include "volmark/gpu/target.h"

#include <cmath>

namespace volmark::gpu::test {

namespace {

using TargetTest = GpuTest;
using glm::vec4;

struct Expected {
  vec4 color;
  float distance;
};

/// Different in every pixel and layer; exact in half floats.
Expected expectedAt(int x, int y, int layer) {
  return {{x / 64.0f, y / 32.0f, 0.5f * static_cast<float>(layer), -2.0f},
          x == 3 ? HUGE_VALF : 1000.25f * static_cast<float>(layer) + 0.1f * static_cast<float>(x + 100 * y)};
}

constexpr const char* kStore =
    "#version 460\nlayout(local_size_x = 8, local_size_y = 8) in;\n"
    "layout(binding = 0, rgba16f) uniform writeonly image2DArray color;\n"
    "layout(binding = 1, r32f) uniform writeonly image2DArray distanceImage;\n"
    "void main() {\n"
    "  ivec3 p = ivec3(gl_GlobalInvocationID);\n"
    "  if (any(greaterThanEqual(p.xy, imageSize(color).xy))) return;\n"
    "  imageStore(color, p, vec4(p.x / 64.0, p.y / 32.0, 0.5 * p.z, -2.0));\n"
    "  float d = p.x == 3 ? uintBitsToFloat(0x7f800000u) : 1000.25 * p.z + 0.1 * float(p.x + 100 * p.y);\n"
    "  imageStore(distanceImage, p, vec4(d));\n"
    "}\n";

constexpr const char* kStoreLayers = "#version 460\nlayout(local_size_x = 8, local_size_y = 8) in;\n"
                                     "layout(binding = 0, rgba32f) uniform writeonly image2DArray normal;\n"
                                     "layout(binding = 1, r32f) uniform writeonly image2DArray steps;\n"
                                     "void main() {\n"
                                     "  ivec3 p = ivec3(gl_GlobalInvocationID);\n"
                                     "  if (any(greaterThanEqual(p.xy, imageSize(normal).xy))) return;\n"
                                     "  imageStore(normal, p, vec4(p.x, -p.y, p.z, 7));\n"
                                     "  imageStore(steps, p, vec4(p.x + 100 * p.y + 10000 * p.z));\n"
                                     "}\n";

} // namespace

TEST_F(TargetTest, ViewsComeBackPixelByPixel) {
  const Target target(device(), 19, 11, 2);
  const Pipeline pipeline(
      device(), ComputePipelineDescription{"store",
                                           {addShader("store.comp.glsl", kStore)},
                                           {{VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE}}});
  Commands commands(device());
  commands.begin();
  target.initialise(commands);
  const Resource resources[] = {StorageImage{target.color.view()}, StorageImage{target.distance.view()}};
  commands.dispatch(pipeline, resources, {}, {3, 2, 2});
  commands.submit();
  commands.wait();
  for (int view = 0; view < 2; ++view) {
    const Picture picture = readBack(device(), target, view);
    ASSERT_EQ(picture.width, 19);
    ASSERT_EQ(picture.height, 11);
    for (int y = 0; y < 11; ++y)
      for (int x = 0; x < 19; ++x) {
        const Expected expected = expectedAt(x, y, view);
        ASSERT_EQ(picture.color[picture.index(x, y)], expected.color) << x << ' ' << y << ' ' << view;
        ASSERT_FLOAT_EQ(picture.distance[picture.index(x, y)], expected.distance) << x << ' ' << y << ' ' << view;
      }
  }
}

TEST_F(TargetTest, DeclaredLayersComeBack) {
  const Target target(device(), 19, 11, 2, {PictureLayer::normal, PictureLayer::steps});
  const Pipeline pipeline(
      device(), ComputePipelineDescription{"layers",
                                           {addShader("layers.comp.glsl", kStoreLayers)},
                                           {{VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE}}});
  Commands commands(device());
  commands.begin();
  target.initialise(commands);
  const Resource resources[] = {StorageImage{target.normal.view()}, StorageImage{target.steps.view()}};
  commands.dispatch(pipeline, resources, {}, {3, 2, 2});
  commands.submit();
  commands.wait();
  for (int view = 0; view < 2; ++view) {
    Picture picture(19, 11);
    readBackLayers(device(), target, view, picture);
    for (int y = 0; y < 11; ++y)
      for (int x = 0; x < 19; ++x) {
        const std::size_t pixel = picture.index(x, y);
        ASSERT_EQ(picture.normal.at(pixel), glm::vec3(x, -y, view));
        ASSERT_EQ(picture.steps.at(pixel), static_cast<float>(x + 100 * y + 10000 * view));
      }
  }
}

TEST_F(TargetTest, UndeclaredLayersAreAbsent) {
  const Target target(device(), 8, 8, 1, {PictureLayer::steps});
  EXPECT_FALSE(target.normal);
  Commands commands(device());
  commands.begin();
  target.initialise(commands);
  commands.submit();
  commands.wait();
  Picture picture = readBack(device(), target, 0);
  EXPECT_TRUE(picture.normal.empty() && picture.steps.empty());
  readBackLayers(device(), target, 0, picture);
  EXPECT_TRUE(picture.normal.empty());
  EXPECT_EQ(picture.steps.size(), 64u);
}

TEST_F(TargetTest, LayersCanBeDrawnTo) {
  const Target target(device(), 8, 8, 2);
  Commands commands(device());
  commands.begin();
  target.initialise(commands);
  for (std::uint32_t layer = 0; layer < 2; ++layer) {
    VkRenderingAttachmentInfo attachments[2]{};
    for (int i = 0; i < 2; ++i) {
      attachments[i].sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
      attachments[i].imageView = i == 0 ? target.color.layerView(layer) : target.distance.layerView(layer);
      attachments[i].imageLayout = VK_IMAGE_LAYOUT_GENERAL;
      attachments[i].loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
      attachments[i].storeOp = VK_ATTACHMENT_STORE_OP_STORE;
      attachments[i].clearValue.color = {{static_cast<float>(layer) + 0.5f, 1, 2, 3}};
    }
    VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
    info.renderArea.extent = {8, 8};
    info.layerCount = 1;
    info.colorAttachmentCount = 2;
    info.pColorAttachments = attachments;
    vkCmdBeginRendering(commands.handle(), &info);
    vkCmdEndRendering(commands.handle());
  }
  commands.submit();
  commands.wait();
  for (int view = 0; view < 2; ++view) {
    const Picture picture = readBack(device(), target, view);
    const float first = static_cast<float>(view) + 0.5f;
    for (const vec4& color : picture.color)
      ASSERT_EQ(color, vec4(first, 1, 2, 3));
    for (const float distance : picture.distance)
      ASSERT_EQ(distance, first);
  }
}

} // namespace volmark::gpu::test
