// Round trips through files that ITK wrote, and agreement of the formats.
#include "volume/dicom_bytes.h"
#include "volume/itk_files.h"
#include "volume/itk_reader.h"
#include "volume/nrrd.h"
#include "volume/orientation.h"
#include "volume/volume_file.h"
#include "volume/volume_files.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <itkGDCMImageIO.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkVTKImageIO.h>
#include <limits>

namespace volmark::test {
namespace {

using Component = itk::CommonEnums::IOComponent;

constexpr std::uint64_t kNoLimit = std::uint64_t(1) << 40;
const glm::ivec3 kDims{5, 4, 3};

/// Distinct values with both extremes of the type.
template <class T> std::vector<T> sampleValues(std::size_t count) {
  std::vector<T> values(count);
  for (std::size_t i = 0; i < count; ++i)
    values[i] = static_cast<T>(static_cast<double>(i) * 1.5);
  values.front() = std::numeric_limits<T>::lowest();
  values.back() = std::numeric_limits<T>::max();
  return values;
}

class ItkFiles : public VolumeFiles {
protected:
  ItkImage image(Component component) const {
    ItkImage image;
    image.dims = kDims;
    image.spacing = {0.5, 1.25, 2};
    image.origin = {3, -7, 11};
    image.component = component;
    return image;
  }

  template <class T> void expectStored(const Volume& volume, const std::vector<T>& values, ScalarType type) {
    ASSERT_EQ(volume.grid().dims, kDims);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(volume.grid().spacingMm[axis], glm::dvec3(0.5, 1.25, 2)[axis], 1e-6);
    ASSERT_EQ(volume.type(), type);
    ASSERT_EQ(volume.voxels().size() * static_cast<std::size_t>(volume.timeSteps()), values.size() * sizeof(T));
    for (int step = 0; step < volume.timeSteps(); ++step) {
      const auto voxels = volume.voxels(step);
      EXPECT_EQ(std::memcmp(voxels.data(), values.data() + static_cast<std::size_t>(step) * voxels.size() / sizeof(T),
                            voxels.size()),
                0);
    }
  }

  template <class T, class Io>
  void roundTrip(Component component, ScalarType type, const std::string& ending, bool compressed, bool bigEndian,
                 int timeSteps = 1) {
    SCOPED_TRACE(fmt::format("{} {} compressed{:d} big{:d}", ending, nameOf(type), compressed, bigEndian));
    const auto values = sampleValues<T>(5 * 4 * 3 * static_cast<std::size_t>(timeSteps));
    ItkImage described = image(component);
    described.compressed = compressed;
    described.bigEndian = bigEndian;
    described.timeSteps = timeSteps;
    const auto path = folder() / fmt::format("{}_{:d}{:d}{}", nameOf(type), compressed, bigEndian, ending);
    writeWithItk(*Io::New(), path, described, values.data());
    const auto volume = loadVolumeFile(path, kNoLimit);
    EXPECT_EQ(volume->timeSteps(), timeSteps);
    expectStored(*volume, values, type);
    EXPECT_TRUE(volume->notes().empty()) << volume->notes().front();
  }

  template <class Io> void everyType(const std::string& ending, bool compressed, bool bigEndian) {
    roundTrip<std::int8_t, Io>(Component::CHAR, ScalarType::int8, ending, compressed, bigEndian);
    roundTrip<std::uint8_t, Io>(Component::UCHAR, ScalarType::uint8, ending, compressed, bigEndian);
    roundTrip<std::int16_t, Io>(Component::SHORT, ScalarType::int16, ending, compressed, bigEndian);
    roundTrip<std::uint16_t, Io>(Component::USHORT, ScalarType::uint16, ending, compressed, bigEndian);
    roundTrip<float, Io>(Component::FLOAT, ScalarType::float32, ending, compressed, bigEndian);
  }
};

TEST_F(ItkFiles, MetaImagesComeBack) {
  for (const char* ending : {".mha", ".mhd"})
    for (const bool compressed : {false, true})
      for (const bool bigEndian : {false, true})
        everyType<itk::MetaImageIO>(ending, compressed, bigEndian);
}

/// A header without what the writer would add: 4 x 3 x 2 of int16.
std::string metaHeader(const std::string& lines, const std::string& dataFile) {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nElementSpacing = 1 1 1\n" + lines +
         "DimSize = 4 3 2\nElementType = MET_SHORT\nElementDataFile = " + dataFile + "\n";
}

TEST_F(ItkFiles, MetaImageByteOrderHasTwoNames) {
  const auto values = sampleValues<std::int16_t>(4 * 3 * 2);
  for (const char* name : {"BinaryDataByteOrderMSB", "ElementByteOrderMSB"})
    for (const bool bigEndian : {false, true}) {
      SCOPED_TRACE(fmt::format("{} = {}", name, bigEndian));
      const auto path =
          write("order.mha", metaHeader(fmt::format("{} = {}\n", name, bigEndian ? "True" : "False"), "LOCAL") +
                                 encoded(values, bigEndian));
      EXPECT_EQ(std::memcmp(loadVolumeFile(path, kNoLimit)->voxels().data(), values.data(), 48), 0);
    }
}

// HeaderSize counts from the start of the file with the voxels, be it the header's own; -1: they are its end.
TEST_F(ItkFiles, MetaImageVoxelsAreWhereHeaderSizeSays) {
  const auto values = sampleValues<std::int16_t>(4 * 3 * 2);
  const std::string voxels = encoded(values, false);
  const auto expectRead = [&](const std::filesystem::path& path) {
    EXPECT_EQ(std::memcmp(loadVolumeFile(path, kNoLimit)->voxels().data(), values.data(), 48), 0) << path;
  };
  for (const std::size_t gap : {0, 1, 7, 300}) {
    const std::string between(gap, 'x');
    write("voxels.raw", between + voxels);
    expectRead(write("apart.mhd", metaHeader(fmt::format("HeaderSize = {}\n", gap), "voxels.raw")));
    expectRead(write("end.mhd", metaHeader("HeaderSize = -1\n", "voxels.raw")));
    for (const char* name : {"LOCAL", "local", "own.mha"}) {
      const auto headerOf = [&](std::size_t size) {
        return metaHeader(fmt::format("HeaderSize = {:4}\n", size), name);
      };
      expectRead(write("own.mha", headerOf(headerOf(0).size() + gap) + between + voxels));
    }
  }
}

TEST_F(ItkFiles, NiftiComesBack) {
  everyType<itk::NiftiImageIO>(".nii", false, false);
  everyType<itk::NiftiImageIO>(".nii.gz", true, false);
}

TEST_F(ItkFiles, VtkImagesComeBack) {
  everyType<itk::VTKImageIO>(".vtk", false, true); // binary VTK is always big endian
}

TEST_F(ItkFiles, TimeStepsComeBack) {
  roundTrip<std::int16_t, itk::NiftiImageIO>(Component::SHORT, ScalarType::int16, ".nii", false, false, 3);
  roundTrip<std::int16_t, itk::MetaImageIO>(Component::SHORT, ScalarType::int16, ".mha", true, false, 3);
}

/// The other byte order of a NIfTI file: ITK writes only this machine's.
TEST_F(ItkFiles, NiftiOfTheOtherByteOrderComesBack) {
  const auto values = sampleValues<std::int16_t>(5 * 4 * 3);
  const auto path = folder() / "native.nii";
  writeWithItk(*itk::NiftiImageIO::New(), path, image(Component::SHORT), values.data());
  std::ifstream file(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(file)), {});
  const auto swap = [&](std::size_t from, std::size_t size, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(from + i * size),
                   bytes.begin() + static_cast<std::ptrdiff_t>(from + (i + 1) * size));
  };
  // nifti1.h: field by field up to the affine rows.
  swap(0, 4, 1);    // sizeof_hdr
  swap(32, 4, 1);   // extents
  swap(36, 2, 1);   // session_error
  swap(40, 2, 8);   // dim
  swap(56, 4, 3);   // intent
  swap(68, 2, 4);   // intent_code .. slice_start
  swap(76, 4, 8);   // pixdim
  swap(108, 4, 3);  // vox_offset, slope, intercept
  swap(120, 2, 1);  // slice_end
  swap(124, 4, 6);  // cal_max .. glmin
  swap(252, 2, 2);  // form codes
  swap(256, 4, 18); // quaternion, offset, rows
  swap(352, 2, values.size());
  expectStored(*loadVolumeFile(write("swapped.nii", bytes), kNoLimit), values, ScalarType::int16);
}

/// NIfTI-1 with what `change` puts into it, and 4 x 3 x 2 of int16.
template <class Change> std::string niftiWith(const std::vector<std::int16_t>& values, Change change) {
  std::string bytes = niftiHeader({4, 3, 2}, 4);
  change([&]<class T>(std::size_t place, T value) { std::memcpy(bytes.data() + place, &value, sizeof(T)); });
  return bytes + encoded(values, false);
}

TEST_F(ItkFiles, NiftiScalingIsApplied) {
  const auto values = sampleValues<std::int16_t>(4 * 3 * 2);
  for (const auto& [slope, intercept] : {std::pair(2.0F, -1000.0F), {-0.5F, 0.0F}, {1.0F, 3.0F}, {0.125F, 7.5F}}) {
    SCOPED_TRACE(fmt::format("{} {}", slope, intercept));
    const auto volume = loadVolumeFile(write("scaled.nii", niftiWith(values,
                                                                     [&](auto put) {
                                                                       put(112, slope);
                                                                       put(116, intercept);
                                                                     })),
                                       kNoLimit);
    ASSERT_EQ(volume->type(), ScalarType::float32);
    for (int i = 0; i < 24; ++i)
      ASSERT_EQ(volume->value(i % 4, i / 4 % 3, i / 12), values[static_cast<std::size_t>(i)] * slope + intercept);
  }
  for (const auto& [slope, intercept] : {std::pair(0.0F, 0.0F), {1.0F, 0.0F}}) {
    SCOPED_TRACE(fmt::format("unscaled {} {}", slope, intercept));
    const auto volume = loadVolumeFile(write("stored.nii", niftiWith(values,
                                                                     [&](auto put) {
                                                                       put(112, slope);
                                                                       put(116, intercept);
                                                                     })),
                                       kNoLimit);
    ASSERT_EQ(volume->type(), ScalarType::int16);
    EXPECT_EQ(std::memcmp(volume->voxels().data(), values.data(), 48), 0);
  }
}

// The axes (right, back, crown) by the quaternion, by the affine rows, or by both: the same patient. NIfTI's own axes
// point to the right, the front and the crown.
TEST_F(ItkFiles, NiftiAxesComeFromEitherForm) {
  const auto values = sampleValues<std::int16_t>(4 * 3 * 2);
  const auto withForms = [&](int quaternion, int affine) {
    return loadVolumeFile(write("forms.nii", niftiWith(values,
                                                       [&](auto put) {
                                                         put(76, 1.0F); // qfac
                                                         put(80, 2.0F);
                                                         put(252, static_cast<std::int16_t>(quaternion));
                                                         put(254, static_cast<std::int16_t>(affine));
                                                         // Half a turn around the crown's axis.
                                                         if (quaternion > 0) put(264, 1.0F);
                                                         put(280, -2.0F);
                                                         put(300, -1.0F);
                                                         put(320, 1.0F);
                                                       })),
                          kNoLimit);
  };
  const auto byQuaternion = withForms(1, 0);
  // To the left and the back: as it is shown.
  EXPECT_EQ(std::memcmp(byQuaternion->voxels().data(), values.data(), 48), 0);
  EXPECT_TRUE(byQuaternion->notes().empty());
  EXPECT_EQ(byQuaternion->grid().spacingMm, glm::dvec3(2, 1, 1));
  for (const auto& volume : {withForms(0, 1), withForms(1, 1), withForms(2, 4)})
    EXPECT_EQ(volume->identity(), byQuaternion->identity());
}

TEST_F(ItkFiles, WiderTypesBecomeFloatWithANote) {
  const std::vector<double> values(5 * 4 * 3, 1.0 / 3);
  writeWithItk(*itk::MetaImageIO::New(), folder() / "double.mha", image(Component::DOUBLE), values.data());
  const auto volume = loadVolumeFile(folder() / "double.mha", kNoLimit);
  EXPECT_EQ(volume->type(), ScalarType::float32);
  EXPECT_EQ(volume->value(2, 1, 1), static_cast<double>(1.0F / 3));
  ASSERT_EQ(volume->notes().size(), 1u);
  EXPECT_NE(volume->notes().front().find("float32"), std::string::npos);
}

// --- Orientation -------------------------------------------------------------------------------------------------

/// A volume whose voxel at the patient's (l, p, s) index is 100 l + 10 p + s, stored with axes `columns`.
struct Stored {
  ItkImage image;
  std::vector<std::int16_t> values;
};
Stored storedWith(const glm::ivec3& fileAxisToPatient, const glm::bvec3& reversed) {
  const glm::ivec3 patientDims{4, 3, 2};
  const glm::dvec3 patientSpacing{0.5, 1.5, 3};
  Stored stored;
  stored.image.directions = glm::dmat3(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    const int patient = fileAxisToPatient[axis];
    stored.image.dims[axis] = patientDims[patient];
    stored.image.spacing[axis] = patientSpacing[patient];
    stored.image.directions[axis][patient] = reversed[axis] ? -1 : 1;
  }
  for (int k = 0; k < stored.image.dims.z; ++k)
    for (int j = 0; j < stored.image.dims.y; ++j)
      for (int i = 0; i < stored.image.dims.x; ++i) {
        const glm::ivec3 file{i, j, k};
        glm::ivec3 patient{0};
        for (int axis = 0; axis < 3; ++axis)
          patient[fileAxisToPatient[axis]] = reversed[axis] ? stored.image.dims[axis] - 1 - file[axis] : file[axis];
        stored.values.push_back(static_cast<std::int16_t>(100 * patient.x + 10 * patient.y + patient.z));
      }
  return stored;
}

TEST_F(ItkFiles, EveryFormatShowsTheSamePatient) {
  const std::vector<glm::ivec3> orders = {{0, 1, 2}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}, {0, 2, 1}, {1, 2, 0}};
  for (std::size_t order = 0; order < orders.size(); ++order)
    for (int flips = 0; flips < 8; ++flips) {
      const Stored stored = storedWith(orders[order], {flips & 1, (flips & 2) != 0, (flips & 4) != 0});
      const std::string name = fmt::format("{}_{}", order, flips);
      SCOPED_TRACE(name);
      std::vector<std::filesystem::path> files;
      const auto add = [&](itk::ImageIOBase::Pointer io, const std::string& ending) {
        files.push_back(folder() / (name + ending));
        writeWithItk(*io, files.back(), stored.image, stored.values.data());
      };
      add(itk::MetaImageIO::New().GetPointer(), ".mha");
      add(itk::NiftiImageIO::New().GetPointer(), ".nii");
      add(itk::NrrdImageIO::New().GetPointer(), ".nrrd");
      std::string identity;
      for (const auto& file : files) {
        SCOPED_TRACE(file.filename());
        const auto volume = loadVolumeFile(file, kNoLimit);
        ASSERT_EQ(volume->grid().dims, glm::ivec3(4, 3, 2));
        for (int axis = 0; axis < 3; ++axis)
          EXPECT_NEAR(volume->grid().spacingMm[axis], glm::dvec3(0.5, 1.5, 3)[axis], 1e-6);
        for (int k = 0; k < 2; ++k)
          for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 4; ++i)
              ASSERT_EQ(volume->value(i, j, k), 100 * i + 10 * j + k);
        EXPECT_EQ(volume->notes().empty(), order == 0 && flips == 0);
      }
    }
}

TEST(Orientation, NamesTheNearestAxesAndTheAngleLeft) {
  const double angle = 20 * M_PI / 180;
  const glm::dmat3 rotated(glm::dvec3(std::cos(angle), std::sin(angle), 0),
                           glm::dvec3(-std::sin(angle), std::cos(angle), 0), glm::dvec3(0, 0, 1));
  const Orientation orientation = nearestOrientation(rotated);
  EXPECT_TRUE(orientation.asStored());
  EXPECT_NEAR(orientation.largestAngleDegrees, 20, 1e-9);
  EXPECT_TRUE(nearestOrientation(glm::dmat3(0.0)).asStored());
  EXPECT_TRUE(nearestOrientation(glm::dmat3(std::nan(""))).asStored());
}

// --- DICOM -------------------------------------------------------------------------------------------------------

class DicomSeries : public VolumeFiles {
protected:
  static constexpr int kColumns = 6;
  static constexpr int kRows = 5;

  struct Settings {
    std::string name;
    glm::dvec3 origin{0};
    std::string series = "1.2.3.4";
    std::string slope = "1";
    std::string intercept = "0";
    int rows = kRows;
    glm::dmat3 directions{1.0};
  };

  static std::vector<std::int16_t> pixels(int slice, int rows = kRows) {
    std::vector<std::int16_t> values(static_cast<std::size_t>(kColumns * rows));
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<std::int16_t>(1000 * slice + static_cast<int>(i));
    return values;
  }

  void addSlice(int slice, const Settings& settings) const {
    ItkImage image;
    image.dims = {kColumns, settings.rows, 1};
    image.spacing = {0.7, 0.8, 2.5};
    image.origin = settings.origin;
    image.directions = settings.directions;
    image.metadata = {{"0020|000e", settings.series},
                      {"0028|1052", settings.intercept},
                      {"0028|1053", settings.slope},
                      {"0008|0060", "CT"}};
    const auto io = itk::GDCMImageIO::New();
    io->SetKeepOriginalUID(true);
    const auto values = pixels(slice, settings.rows);
    writeWithItk(*io, folder() / (settings.name + ".dcm"), image, values.data());
  }

  void expectRefused(const std::string& part) {
    expectInputError([&] { loadVolumeFile(folder(), kNoLimit); }, part);
  }
};

TEST_F(DicomSeries, SlicesAreOrderedByPlaceNotByName) {
  // Names run against the places.
  for (int slice = 0; slice < 4; ++slice)
    addSlice(slice, {.name = fmt::format("s{}", 9 - slice), .origin = {1, 2, 10 + 3.0 * slice}});
  write("README.txt", "no DICOM");
  const auto volume = loadVolumeFile(folder(), kNoLimit);
  ASSERT_EQ(volume->grid().dims, glm::ivec3(kColumns, kRows, 4));
  EXPECT_NEAR(volume->grid().spacingMm.x, 0.7, 1e-6);
  EXPECT_NEAR(volume->grid().spacingMm.y, 0.8, 1e-6);
  EXPECT_NEAR(volume->grid().spacingMm.z, 3, 1e-6);
  for (int slice = 0; slice < 4; ++slice)
    EXPECT_EQ(volume->value(1, 2, slice), 1000 * slice + 2 * kColumns + 1);
  EXPECT_TRUE(volume->notes().empty());
}

TEST_F(DicomSeries, SlopeAndInterceptAreApplied) {
  for (int slice = 0; slice < 3; ++slice)
    addSlice(slice,
             {.name = fmt::format("s{}", slice), .origin = {0, 0, double(slice)}, .slope = "2", .intercept = "-1024"});
  // ITK stores (value + 1024) / 2, so that even values come back: 2008 is stored as 1516.
  EXPECT_EQ(loadVolumeFile(folder(), kNoLimit)->value(2, 1, 2), 2000 + kColumns + 2);
}

TEST_F(DicomSeries, Jpeg2000ComesBack) {
  ItkImage image;
  image.dims = {64, 48, 1};
  image.compressed = true;
  image.metadata = {{"0020|000e", "1.2.3.4"}, {"0008|0060", "CT"}};
  const auto values = sampleValues<std::int16_t>(64 * 48);
  const auto io = itk::GDCMImageIO::New();
  io->SetCompressionType(itk::GDCMImageIO::JPEG2000);
  writeWithItk(*io, folder() / "a.dcm", image, values.data());
  EXPECT_LT(std::filesystem::file_size(folder() / "a.dcm"), 64u * 48 * 2);
  EXPECT_EQ(std::memcmp(loadVolumeFile(folder(), kNoLimit)->voxels().data(), values.data(), 64 * 48 * 2), 0);
}

// Run lengths by hand: a table of two parts, the high and the low bytes, each as literal runs of at most 128.
TEST_F(DicomSeries, RunLengthsComeBack) {
  std::string high;
  std::string low;
  for (int i = 0; i < 12; ++i) {
    high += static_cast<char>(i / 5);
    low += static_cast<char>(250 - 10 * i);
  }
  const auto run = [](const std::string& bytes) { return static_cast<char>(bytes.size() - 1) + bytes; };
  std::string table(64, '\0');
  table[0] = 2;
  table[4] = 64;
  table[8] = static_cast<char>(64 + run(high).size() + 1);
  const std::string parts = table + run(high) + '\0' + run(low) + '\0';
  Dicom dicom;
  dicom.element(0x00020010, "UI", std::string("1.2.840.10008.1.2.5\0", 20));
  dicom.bytes += slice().bytes.substr(slice().bytes.find(std::string("\x20\0\x0e\0", 4)));
  dicom.longElement(0x7fe00010, "OB", Dicom::kOpen,
                    Dicom::item(0, "") + Dicom::item(static_cast<std::uint32_t>(parts.size()), parts) +
                        Dicom::kSequenceEnd);
  write("runs.dcm", dicom.bytes);
  const auto volume = loadVolumeFile(folder(), kNoLimit);
  ASSERT_EQ(volume->grid().dims, glm::ivec3(4, 3, 1));
  for (int i = 0; i < 12; ++i)
    ASSERT_EQ(volume->value(i % 4, i / 4, 0), 256 * (i / 5) + (250 - 10 * i));
}

TEST_F(DicomSeries, UnevenDistancesAndTiltAreNoted) {
  for (const double z : {0.0, 1.0, 3.0})
    addSlice(0, {.name = fmt::format("s{}", z), .origin = {0, 0.2 * z, z}});
  const auto volume = loadVolumeFile(folder(), kNoLimit);
  ASSERT_EQ(volume->notes().size(), 2u);
  EXPECT_NE(volume->notes()[0].find("1 to 2 mm apart"), std::string::npos) << volume->notes()[0];
  EXPECT_NE(volume->notes()[1].find("tilted gantry"), std::string::npos) << volume->notes()[1];
  EXPECT_NEAR(volume->grid().spacingMm.z, 1.5, 1e-6);
}

TEST_F(DicomSeries, TwoSeriesAreRefused) {
  addSlice(0, {.name = "a", .origin = {0, 0, 0}, .series = "1.2.3"});
  addSlice(1, {.name = "b", .origin = {0, 0, 1}, .series = "1.2.4"});
  expectRefused("found 2 series: \"1.2.3\" (1 files), \"1.2.4\" (1 files)");
}

TEST_F(DicomSeries, TwoSlicesInOnePlaceAreRefused) {
  addSlice(0, {.name = "a"});
  addSlice(1, {.name = "b"});
  expectRefused("lies where a.dcm lies");
}

TEST_F(DicomSeries, SlicesOfAnotherSizeAreRefused) {
  addSlice(0, {.name = "a"});
  addSlice(1, {.name = "b", .origin = {0, 0, 1}, .rows = kRows + 1});
  expectRefused("is not that of a.dcm");
}

TEST_F(DicomSeries, FoldersWithoutDicomAreRefused) {
  write("a.txt", "text");
  expectRefused("there is no DICOM file in this folder");
}

TEST_F(DicomSeries, EveryCutOffFileIsRefused) {
  addSlice(0, {.name = "whole"});
  std::ifstream file(folder() / "whole.dcm", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  std::filesystem::remove(folder() / "whole.dcm");
  for (std::size_t length = 132; length < bytes.size(); length += 7) {
    write("cut.dcm", bytes.substr(0, length));
    expectInputError([&] { loadVolumeFile(folder(), kNoLimit); }, "cut.dcm");
  }
}

} // namespace
} // namespace volmark::test
