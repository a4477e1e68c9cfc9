#include "volume/volume_cache.h"
#include "volume/volume_file.h"
#include "volume/volume_files.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <numeric>

namespace volmark::test {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kNoLimit = std::uint64_t(1) << 40;
constexpr int kSide = 128; // 2 MiB of uint8

class VolumeCache : public VolumeFiles {
protected:
  VolumeCache() { ::setenv("VOLMARK_CACHE", (folder() / "cache").c_str(), 1); }
  ~VolumeCache() override {
    ::unsetenv("VOLMARK_CACHE");
    ::unsetenv("VOLMARK_VOLUME_CACHE_GIB");
  }

  /// A gzip NRRD whose voxels are all `value`, changed long enough ago.
  fs::path writeVolume(const std::string& name, char value) const {
    const std::string header = fmt::format("NRRD0004\ntype: uint8\ndimension: 3\nsizes: {0} {0} {0}\n"
                                           "spacings: 1 2 3\nencoding: gzip\n\n",
                                           kSide);
    const fs::path path = write(name, header + gzipped(std::string(std::size_t(kSide) * kSide * kSide, value)));
    fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(1));
    return path;
  }
  std::vector<fs::path> kept() const {
    std::vector<fs::path> files;
    std::error_code missing;
    for (const auto& entry : fs::directory_iterator(folder() / "cache" / "volumes", missing))
      files.push_back(entry.path());
    return files;
  }
};

TEST_F(VolumeCache, TheSecondReadingDoesNotDecode) {
  const fs::path path = writeVolume("a.nrrd", 7);
  int decoded = 0;
  const auto read = [&] {
    return cachedVolume({path}, "test", kNoLimit, [&] {
      ++decoded;
      return loadVolumeFile(path, kNoLimit);
    });
  };
  const auto first = read();
  const auto second = read();
  EXPECT_EQ(decoded, 1);
  EXPECT_EQ(second->identity(), first->identity());
  EXPECT_EQ(second->grid().spacingMm, glm::dvec3(1, 2, 3));
  EXPECT_EQ(second->value(5, 6, 7), 7);
}

TEST_F(VolumeCache, AChangedFileIsDecodedAnew) {
  const fs::path path = writeVolume("a.nrrd", 7);
  EXPECT_EQ(loadVolumeFile(path, kNoLimit)->value(0, 0, 0), 7);
  writeVolume("a.nrrd", 8);
  EXPECT_EQ(loadVolumeFile(path, kNoLimit)->value(0, 0, 0), 8);
}

// Of the same length, a nanosecond later or in another file of the same name and time.
TEST_F(VolumeCache, TheSmallestChangeCounts) {
  const fs::path path = writeVolume("a.nrrd", 7);
  const fs::file_time_type time = fs::last_write_time(path);
  loadVolumeFile(path, kNoLimit);
  EXPECT_EQ(kept().size(), 1u);

  writeVolume("a.nrrd", 8);
  fs::last_write_time(path, time + std::chrono::nanoseconds(1));
  EXPECT_EQ(loadVolumeFile(path, kNoLimit)->value(0, 0, 0), 8);
  EXPECT_EQ(kept().size(), 2u);

  const fs::path other = writeVolume("b.nrrd", 9);
  fs::last_write_time(other, time + std::chrono::nanoseconds(1));
  ASSERT_EQ(fs::file_size(other), fs::file_size(path));
  fs::rename(other, path);
  EXPECT_EQ(loadVolumeFile(path, kNoLimit)->value(0, 0, 0), 9);
  EXPECT_EQ(kept().size(), 3u);
}

TEST_F(VolumeCache, FilesThatJustChangedAreNotKept) {
  const fs::path path = writeVolume("a.nrrd", 7);
  fs::last_write_time(path, fs::file_time_type::clock::now());
  loadVolumeFile(path, kNoLimit);
  EXPECT_TRUE(kept().empty());
}

TEST_F(VolumeCache, DamagedFilesOfTheCacheAreWrittenAnew) {
  const fs::path path = writeVolume("a.nrrd", 7);
  loadVolumeFile(path, kNoLimit);
  ASSERT_EQ(kept().size(), 1u);
  const std::uintmax_t whole = fs::file_size(kept().front());
  for (const std::uintmax_t place : {std::uintmax_t(3), std::uintmax_t(5000), whole - 1}) {
    {
      std::fstream file(kept().front(), std::ios::binary | std::ios::in | std::ios::out);
      file.seekp(static_cast<std::streamoff>(place));
      file.put('\x55');
    }
    EXPECT_EQ(loadVolumeFile(path, kNoLimit)->value(kSide - 1, kSide - 1, kSide - 1), 7);
  }
  fs::resize_file(kept().front(), whole / 2);
  EXPECT_EQ(loadVolumeFile(path, kNoLimit)->value(kSide - 1, kSide - 1, kSide - 1), 7);
  EXPECT_EQ(fs::file_size(kept().front()), whole);
}

TEST_F(VolumeCache, DropsWhatWasUsedLongestAgo) {
  ::setenv("VOLMARK_VOLUME_CACHE_GIB", "0.005", 1); // two of 2 MiB
  const std::vector<fs::path> paths = {writeVolume("a.nrrd", 1), writeVolume("b.nrrd", 2), writeVolume("c.nrrd", 3)};
  loadVolumeFile(paths[0], kNoLimit);
  ASSERT_EQ(kept().size(), 1u);
  const fs::path oldest = kept().front();
  fs::last_write_time(oldest, fs::file_time_type::clock::now() - std::chrono::hours(1));
  loadVolumeFile(paths[1], kNoLimit);
  loadVolumeFile(paths[2], kNoLimit);
  EXPECT_EQ(kept().size(), 2u);
  EXPECT_FALSE(fs::exists(oldest));
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(loadVolumeFile(paths[static_cast<std::size_t>(i)], kNoLimit)->value(1, 1, 1), i + 1);
}

TEST_F(VolumeCache, DropsWhatAKilledProcessLeft) {
  fs::create_directories(folder() / "cache" / "volumes");
  const fs::path left = write("cache/volumes/0123.voxels.4567", "half of it");
  const fs::path written = write("cache/volumes/0123.voxels.4568", "by somebody right now");
  fs::last_write_time(left, fs::file_time_type::clock::now() - std::chrono::hours(1));
  loadVolumeFile(writeVolume("a.nrrd", 7), kNoLimit);
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(written));
  EXPECT_EQ(kept().size(), 2u);
}

TEST_F(VolumeCache, CanBeOffAndRefusesOtherText) {
  const fs::path path = writeVolume("a.nrrd", 7);
  ::setenv("VOLMARK_VOLUME_CACHE_GIB", "0", 1);
  EXPECT_EQ(loadVolumeFile(path, kNoLimit)->value(0, 0, 0), 7);
  EXPECT_TRUE(kept().empty());
  for (const char* text : {"many", "-1", "1x", "nan"}) {
    ::setenv("VOLMARK_VOLUME_CACHE_GIB", text, 1);
    expectInputError([&] { loadVolumeFile(path, kNoLimit); }, "VOLMARK_VOLUME_CACHE_GIB");
  }
}

TEST_F(VolumeCache, WithoutAPlaceToWriteItOnlyCostsTime) {
  const fs::path path = writeVolume("a.nrrd", 7);
  write("cache", "a file, no folder");
  EXPECT_EQ(loadVolumeFile(path, kNoLimit)->value(0, 0, 0), 7);
}

TEST_F(VolumeCache, TheLimitHoldsForWhatIsKept) {
  const fs::path path = writeVolume("a.nrrd", 7);
  loadVolumeFile(path, kNoLimit);
  expectInputError([&] { loadVolumeFile(path, 1000); }, "allowed: 1000 bytes");
}

class TimeSeries : public VolumeFiles {
protected:
  fs::path step(const std::string& name, const std::string& sizes, char value) const {
    return write(name, fmt::format("NRRD0004\ntype: uint8\ndimension: 3\nsizes: {}\nencoding: raw\n\n", sizes) +
                           std::string(24, value));
  }
};

TEST_F(TimeSeries, FilesBecomeTheStepsOfOneVolume) {
  const auto volume = loadTimeSeries({step("a.nrrd", "4 3 2", 1), step("b.nrrd", "4 3 2", 2)}, kNoLimit);
  EXPECT_EQ(volume->timeSteps(), 2);
  EXPECT_EQ(volume->value(3, 2, 1, 0), 1);
  EXPECT_EQ(volume->value(0, 0, 0, 1), 2);
}

TEST_F(TimeSeries, StepsOfAnotherSizeAreRefused) {
  expectInputError(
      [&] {
        loadTimeSeries({step("a.nrrd", "4 3 2", 1), step("b.nrrd", "3 4 2", 2)}, kNoLimit);
      },
      "b.nrrd: its size, spacing, type or time steps are not those of a.nrrd");
}

class TimeSeriesMemory : public Refusals {};

// 3 GB by the first file, nothing in the second.
TEST_F(TimeSeriesMemory, GrowsWithTheSteps) {
  const auto first = writeSparse("a.nrrd",
                                 "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 256 256 64\nencoding: raw\n"
                                 "byte skip: -1\n\n",
                                 (std::uintmax_t(1) << 22) + 200);
  const auto second = write("b.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1 1 1\nencoding: raw\n\nx");
  std::vector<fs::path> steps(800, second);
  steps.front() = first;
  expectInputError([&] { loadTimeSeries(steps, kNoLimit); }, "b.nrrd: its size, spacing, type or time steps");
}

TEST_F(TimeSeries, TheLimitIsForAllOfThem) {
  expectInputError(
      [&] {
        loadTimeSeries({step("a.nrrd", "4 3 2", 1), step("b.nrrd", "4 3 2", 2)}, 40);
      },
      "allowed: 40 bytes");
}

} // namespace
} // namespace volmark::test
