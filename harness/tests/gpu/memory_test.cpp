#include "gpu_test.h"
#include "volmark/error.h"

#include <thread>
#include <type_traits>

namespace volmark::gpu::test {

namespace {

using MemoryTest = GpuTest;

template <class T> constexpr bool isMoveOnly() {
  return std::is_nothrow_move_constructible_v<T> && std::is_nothrow_move_assignable_v<T> &&
         !std::is_copy_constructible_v<T> && !std::is_copy_assignable_v<T>;
}
static_assert(isMoveOnly<Buffer>() && isMoveOnly<Image>() && isMoveOnly<Sampler>() && isMoveOnly<Pipeline>());

ImageDescription picture(const char* name, std::uint32_t layers = 1) {
  ImageDescription description;
  description.name = name;
  description.format = VK_FORMAT_R32_SFLOAT;
  description.extent = {16, 8, 1};
  description.layers = layers;
  description.usage = VK_IMAGE_USAGE_STORAGE_BIT;
  return description;
}

} // namespace

TEST(MemoryLedger, AddsByNameAndKeepsThePeak) {
  MemoryLedger ledger;
  ledger.add("b", 10);
  ledger.add("a", 5);
  ledger.add("b", 1);
  ledger.remove("b", 10);
  ASSERT_EQ(ledger.items().size(), 2u);
  EXPECT_EQ(ledger.items()[0].name, "a");
  EXPECT_EQ(ledger.items()[1].bytes, 1u);
  EXPECT_EQ(ledger.totalBytes(), 6u);
  EXPECT_EQ(ledger.peakBytes(), 16u);
  ledger.resetPeak();
  EXPECT_EQ(ledger.peakBytes(), 6u);
  ledger.remove("a", 5);
  ledger.remove("b", 1);
  EXPECT_TRUE(ledger.items().empty());
}

TEST(MemoryLedger, CountsFromManyThreads) {
  MemoryLedger ledger;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&ledger] {
      for (int i = 0; i < 1000; ++i) {
        ledger.add("x", 3);
        ledger.remove("x", 2);
      }
    });
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(ledger.totalBytes(), 4000u);
}

TEST_F(MemoryTest, BuffersAndImagesAreInTheLedgerWhileTheyLive) {
  MemoryLedger& ledger = device().ledger();
  const std::uint64_t before = ledger.totalBytes();
  {
    const Buffer buffer(device(), {"numbers", 1000, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT});
    const Image image(device(), picture("picture", 2));
    EXPECT_GE(buffer.memory().bytes, 1000u);
    EXPECT_GE(image.memory().bytes, 2u * 16 * 8 * 4);
    EXPECT_EQ(image.memory().name, "picture");
    EXPECT_EQ(ledger.totalBytes(), before + buffer.memory().bytes + image.memory().bytes);
    // The harness's own staging memory is not the technique's.
    const Buffer nameless(device(), {"", 1000, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT});
    EXPECT_EQ(ledger.totalBytes(), before + buffer.memory().bytes + image.memory().bytes);
  }
  EXPECT_EQ(ledger.totalBytes(), before);
}

TEST_F(MemoryTest, MovingTakesTheResourceAlong) {
  Buffer a(device(), {"a", 64, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT});
  const VkBuffer handle = a.handle();
  Buffer b(std::move(a));
  EXPECT_FALSE(a); // NOLINT(bugprone-use-after-move): moved-from objects are empty
  EXPECT_EQ(b.handle(), handle);
  b = Buffer(device(), {"c", 64, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT});
  const auto items = device().ledger().items();
  EXPECT_TRUE(std::none_of(items.begin(), items.end(), [](const MemoryItem& item) { return item.name == "a"; }));

  Image image(device(), picture("picture", 3));
  const VkImageView view = image.layerView(2);
  Image moved = std::move(image);
  EXPECT_FALSE(image); // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(moved.layerView(2), view);
  moved = Image();
  EXPECT_FALSE(moved);

  Sampler sampler(device(), VK_FILTER_LINEAR);
  const Sampler other = std::move(sampler);
  EXPECT_EQ(sampler.handle(), VkSampler(VK_NULL_HANDLE)); // NOLINT(bugprone-use-after-move)
  EXPECT_NE(other.handle(), VkSampler(VK_NULL_HANDLE));
}

TEST_F(MemoryTest, WhatTheDeviceCannotHoldIsUnsupported) {
  const std::uint64_t most = device().facts().maximumAllocationBytes;
  if (most < (std::uint64_t(1) << 50)) {
    EXPECT_THROW(Buffer(device(), {"huge", most + 1, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT}), UnsupportedError);
  }
  ImageDescription wide = picture("wide");
  wide.extent.width = device().facts().maximumImageDimension2D + 1;
  EXPECT_THROW(Image(device(), wide), UnsupportedError);
  ImageDescription wrong = picture("wrong format");
  wrong.format = VK_FORMAT_R8G8B8_SRGB;
  EXPECT_THROW(Image(device(), wrong), UnsupportedError);
  ImageDescription heavy = picture("heavy");
  heavy.type = VK_IMAGE_TYPE_3D;
  heavy.extent = {2048, 2048, 2048};
  if (device().facts().maximumImageDimension3D >= 2048 && most < (std::uint64_t(32) << 30)) {
    EXPECT_THROW(Image(device(), heavy), UnsupportedError);
  }
}

} // namespace volmark::gpu::test
