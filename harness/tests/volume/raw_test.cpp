#include "volume/raw.h"
#include "volume/volume_files.h"

#include <cstdint>
#include <limits>

namespace volmark::test {
namespace {

constexpr std::uint64_t kNoLimit = std::uint64_t(1) << 40;

class Raw : public VolumeFiles {};

TEST_F(Raw, ReadsBothByteOrdersBehindAnOffset) {
  const std::vector<std::int16_t> values = {-1000, 0, 1, 300, 32767, -32768};
  for (const bool bigEndian : {false, true}) {
    const auto path = write("volume.raw", "head" + encoded(values, bigEndian));
    RawDescription description{.grid = {{3, 1, 1}, {1, 2, 3}}, .type = ScalarType::int16, .bigEndian = bigEndian};
    description.offsetBytes = 4;
    description.timeSteps = 2;
    const auto volume = loadRaw(path, description, kNoLimit);
    for (int i = 0; i < 6; ++i)
      EXPECT_EQ(volume->value(i % 3, 0, 0, i / 3), values[static_cast<std::size_t>(i)]);
    EXPECT_EQ(volume->grid().spacingMm, glm::dvec3(1, 2, 3));
  }
}

TEST_F(Raw, RefusesOtherLengths) {
  const auto path = write("volume.raw", "abcdefgh");
  const auto load = [&](glm::ivec3 dims, std::uint64_t offset, std::uint64_t limit) {
    loadRaw(path, {.grid = {dims, {1, 1, 1}}, .offsetBytes = offset}, limit);
  };
  EXPECT_NO_THROW(load({2, 2, 2}, 0, 8));
  expectInputError([&] { load({2, 2, 2}, 0, 7); }, "allowed: 7 bytes");
  expectInputError([&] { load({2, 2, 2}, 1, kNoLimit); }, "the file has 8 bytes, expected 8 bytes of voxels after 1");
  expectInputError([&] { load({2, 2, 1}, 0, kNoLimit); }, "the file has 8 bytes, expected 4");
  expectInputError([&] { load({2, 2, 2}, std::numeric_limits<std::uint64_t>::max(), kNoLimit); }, "the file has 8");
  expectInputError([&] { load({2, 0, 2}, 0, kNoLimit); }, "at least 1");
  expectInputError([&] { load({2, -4, -1}, 0, kNoLimit); }, "at least 1");
  const int most = std::numeric_limits<int>::max();
  expectInputError([&] { load({most, most, most}, 0, kNoLimit); }, "allowed: 1099511627776 bytes");
  expectInputError([&] { loadRaw(folder() / "absent.raw", {}, kNoLimit); }, "no such file");
}

} // namespace
} // namespace volmark::test
