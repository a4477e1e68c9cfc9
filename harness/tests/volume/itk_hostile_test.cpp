// Files that pass our own check, and that a library stumbles over all the same.
#include "volume/dicom_bytes.h"
#include "volume/itk/decode_apart.h"
#include "volume/itk_files.h"
#include "volume/volume_file.h"
#include "volume/volume_files.h"

#include <fmt/format.h>

#include <csignal>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <itkGDCMImageIO.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkVTKImageIO.h>
#include <random>
#include <stdexcept>
#include <unistd.h>

namespace volmark::test {
namespace {

constexpr std::uint64_t kLimit = 1u << 20;

/// Decodes something in a process of its own.
class DecodeApart : public Refusals {
protected:
  static void expectRefused(const std::function<void()>& harm, const std::string& says) {
    expectInputError(
        [&] {
          decodeApart("a.dcm", 1000, [&] {
            harm();
            return DecodedVolume{};
          });
        },
        says);
  }
};

TEST_F(DecodeApart, VolumesComeBack) {
  DecodedVolume made{"a", {{40, 30, 20}, {0.1, 1.0 / 3, 1e-7}}, ScalarType::int16, 2, {}, {"one", "t\"wo\n"}};
  for (int i = 0; i < 40 * 30 * 20 * 2 * 2; ++i)
    made.voxels.push_back(static_cast<std::byte>(i * 2654435761u >> 24));
  const auto volume = decodeApart("a.dcm", 1000, [&] { return made; });
  EXPECT_EQ(volume->name(), made.name);
  EXPECT_EQ(volume->grid().dims, made.grid.dims);
  EXPECT_EQ(volume->grid().spacingMm, made.grid.spacingMm);
  EXPECT_EQ(volume->type(), made.type);
  EXPECT_EQ(volume->timeSteps(), 2);
  EXPECT_EQ(volume->notes(), made.notes);
  for (const int step : {0, 1})
    EXPECT_EQ(std::memcmp(volume->voxels(step).data(), made.voxels.data() + step * 48'000, 48'000), 0);
}

TEST_F(DecodeApart, WhatIsWrongIsToldInOneLine) {
  expectRefused([] { throw InputError("a.dcm: so and so"); }, "a.dcm: so and so");
  expectRefused([] { throw std::runtime_error("strange"); }, "a.dcm: strange");
  expectRefused([] { throw 5; }, "a.dcm: the library that reads it gave up (Aborted)");
  expectRefused([] { std::abort(); }, "a.dcm: the library that reads it gave up (Aborted)");
  expectRefused([] { std::raise(SIGFPE); }, "gave up (Floating point exception)");
  expectRefused([] { ::_exit(3); }, "gave up (exit code 3)");
  expectRefused([] { std::raise(SIGXCPU); }, "gave up (not done after");
  expectRefused([] { std::vector<char>(std::size_t(3) << 30, 'x'); }, "a.dcm: ");
}

TEST_F(DecodeApart, TimeIsLimitedAndInterruptsAreForTheParent) {
  const auto volume = decodeApart("a.dcm", 1000, [] {
    rlimit limit{};
    getrlimit(RLIMIT_CPU, &limit);
    std::raise(SIGINT);
    return DecodedVolume{"", {}, ScalarType::uint8, 1, {std::byte(1)}, {fmt::format("{}", limit.rlim_cur)}};
  });
  EXPECT_LE(std::stoul(volume->notes().at(0)), 60u);
}

TEST_F(DecodeApart, LibrariesAreNotHeard) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  decodeApart("a.dcm", 1000, [] {
    std::cerr << "warning" << std::endl;
    std::cout << "note" << std::endl;
    return DecodedVolume{"", {}, ScalarType::uint8, 1, {std::byte(1)}, {}};
  });
  EXPECT_EQ(testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout(), "");
}

class HostileSeries : public Refusals {
protected:
  void expectRefused(const std::string& part) {
    expectInputError([&] { loadVolumeFile(folder(), kLimit); }, part);
  }
  static Dicom whole() { return slice().longElement(0x7fe00010, "OW", 24, std::string(24, '\1')); }
};

TEST_F(HostileSeries, LengthsBehindAndInsideOfWhatWeLookAt) {
  Dicom behind = whole();
  behind.longElement(0xfffcfffc, "OB", 0xfffffff0, "0123");
  write("behind.dcm", behind.bytes);
  expectRefused("behind.dcm: ");
  std::filesystem::remove(folder() / "behind.dcm");

  Dicom inner;
  inner.bytes.clear();
  inner.longElement(0x00089999, "OB", 0xfffffff0, "0123");
  const std::string item = Dicom::item(static_cast<std::uint32_t>(inner.bytes.size()), inner.bytes);
  Dicom outer = slice();
  outer.longElement(0x00081115, "SQ", static_cast<std::uint32_t>(item.size()), item)
      .longElement(0x7fe00010, "OW", 24, std::string(24, '\1'));
  write("inside.dcm", outer.bytes);
  expectRefused("inside.dcm: ");
}

TEST_F(HostileSeries, RunLengthsOfNothing) {
  Dicom dicom;
  dicom.element(0x00020010, "UI", "1.2.840.10008.1.2.5");
  dicom.bytes += slice().bytes.substr(slice().bytes.find(std::string("\x20\0\x0e\0", 4)));
  dicom.longElement(0x7fe00010, "OB", Dicom::kOpen,
                    Dicom::item(0, "") + Dicom::item(64, std::string(64, '\0')) + Dicom::kSequenceEnd);
  write("runs.dcm", dicom.bytes);
  expectRefused("");
}

TEST_F(HostileSeries, NamesStayInTheirLine) {
  write("a.dcm", whole().bytes);
  std::string other = whole().bytes;
  other.replace(other.find("1.2.3.4"), 7, "1\n\x1b[31m");
  write("b.dcm", other);
  expectRefused("found 2 series: \"1??[31m\" (1 files), \"1.2.3.4\" (1 files)");
}

TEST_F(HostileSeries, WhatIsNoFileIsPassedOver) {
  write("a.dcm", whole().bytes);
  std::filesystem::create_symlink("itself", folder() / "itself");
  std::filesystem::create_symlink("nowhere", folder() / "broken");
  std::filesystem::create_directories(folder() / "inner");
  ASSERT_EQ(::mkfifo((folder() / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(loadVolumeFile(folder(), kLimit)->grid().dims, glm::ivec3(4, 3, 1));
}

/// Damaged copies of files that ITK wrote, given to ITK where our check lets them pass.
class Damage : public VolumeFiles {
protected:
  void damageAndRead(itk::ImageIOBase& io, const std::string& ending, int depth, int copies) {
    ItkImage image;
    image.dims = {6, 5, depth};
    image.metadata = {{"0020|000e", "1.2.3.4"}};
    const std::vector<std::int16_t> values(static_cast<std::size_t>(6 * 5 * depth), 7);
    const auto whole = folder() / ("whole" + ending);
    writeWithItk(io, whole, image, values.data());
    std::ifstream file(whole, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
    std::filesystem::remove(whole);

    std::mt19937 random(1); // the same numbers everywhere
    int read = 0;
    for (int i = 0; i < copies; ++i) {
      std::string damaged = bytes;
      // The voxels alone would hide the headers.
      const std::size_t header = bytes.size() - values.size() * 2;
      for (std::size_t times = 1 + random() % 3; times > 0; --times)
        damaged[random() % header] = static_cast<char>(random());
      const auto path = write("damaged" + ending, damaged);
      try {
        loadVolumeFile(ending == ".dcm" ? folder() : path, kLimit);
        ++read;
      } catch (const InputError& error) {
        const std::string text = error.what();
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        EXPECT_LT(text.size(), 600u) << text;
      }
    }
    EXPECT_GT(read, 0); // some damage is in names and dates
  }
};

TEST_F(Damage, OfMetaImagesIsOneLine) {
  damageAndRead(*itk::MetaImageIO::New(), ".mha", 4, 150);
}
TEST_F(Damage, OfNiftiIsOneLine) {
  damageAndRead(*itk::NiftiImageIO::New(), ".nii", 4, 150);
}
TEST_F(Damage, OfVtkIsOneLine) {
  damageAndRead(*itk::VTKImageIO::New(), ".vtk", 4, 150);
}
TEST_F(Damage, OfDicomIsOneLine) {
  const auto io = itk::GDCMImageIO::New();
  io->SetKeepOriginalUID(true);
  damageAndRead(*io, ".dcm", 1, 150);
}

} // namespace
} // namespace volmark::test
