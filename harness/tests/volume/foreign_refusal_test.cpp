// Lying, truncated and malicious headers of the formats that ITK reads: one line, before ITK sees the file.
#include "volume/dicom_bytes.h"
#include "volume/file_claims.h"
#include "volume/volume_files.h"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>

namespace volmark::test {
namespace {

constexpr std::uint64_t kLimit = std::uint64_t(1) << 32;

// --- MetaImage -------------------------------------------------------------------------------------------------

std::string metaHeader(const std::string& changed = "", const std::string& by = "") {
  std::string text = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                     "CompressedData = False\nElementSpacing = 1 1 1\nDimSize = 4 3 2\nElementType = MET_SHORT\n"
                     "ElementDataFile = LOCAL\n";
  if (!changed.empty()) text.replace(text.find(changed), changed.size(), by);
  return text;
}

struct Lie {
  const char* changed;
  const char* by;
  const char* says;
};
void PrintTo(const Lie& lie, std::ostream* out) {
  *out << lie.by;
}

class MetaImageLies : public Refusals, public testing::WithParamInterface<Lie> {};
TEST_P(MetaImageLies, AreOneLine) {
  const auto path = write("lie.mha", metaHeader(GetParam().changed, GetParam().by) + std::string(48, '\1'));
  expectInputError([&] { checkMetaImage(path, kLimit); }, GetParam().says);
}
INSTANTIATE_TEST_SUITE_P(
    All, MetaImageLies,
    testing::Values(Lie{"4 3 2", "4 3 3", "found 48 bytes of voxels, expected 72"},
                    Lie{"4 3 2", "100000 100000 100000", "allowed: 4294967296 bytes in all"},
                    Lie{"4 3 2", "2147483647 2147483647 2147483647", "allowed: 4294967296 bytes in all"},
                    Lie{"4 3 2", "-4 3 2", "DimSize: found \"-4\""}, Lie{"4 3 2", "4 3", "DimSize: found \"4 3\""},
                    Lie{"4 3 2", "0 3 2", "DimSize: found \"0\""}, Lie{"4 3 2", "4.5 3 2", "DimSize: found \"4.5\""},
                    Lie{"NDims = 3", "NDims = 12", "NDims: found \"12\""},
                    Lie{"MET_SHORT", "MET_OTHER", "ElementType: found \"MET_OTHER\""},
                    Lie{"MET_SHORT", "MET_LONG_LONG", "ElementType: found"},
                    Lie{"BinaryData = True", "BinaryData = False", "BinaryData: found \"False\", allowed: True"},
                    Lie{"NDims = 3", "NDims = 3\nElementNumberOfChannels = 3", "ElementNumberOfChannels: found \"3\""},
                    Lie{"LOCAL", "LIST", "ElementDataFile: found \"LIST\""},
                    Lie{"LOCAL", "slice%d.raw 1 9 1", "ElementDataFile: found"},
                    Lie{"LOCAL", "missing.raw", "missing.raw: no such file"},
                    Lie{"LOCAL", "/dev/zero", "not a regular file"},
                    Lie{"NDims = 3", "NDims = 3\nHeaderSize = 99999999", "found 0 bytes of voxels"},
                    Lie{"NDims = 3\n", "NDims = 3\nNDims = 3\n", "NDims: found \"twice\""},
                    Lie{"NDims = 3", "NDims = 3\nDimSize: 9 9 9 =", "header line \"DimSize: 9 9 9 =\""},
                    Lie{"NDims = 3", "noise", "not a MetaImage: header line \"noise\""},
                    Lie{"CompressedData = False", "CompressedData = True\nCompressedDataSize = 999999",
                        "CompressedDataSize: found \"999999\", allowed: at most the 48 bytes"},
                    Lie{"CompressedData = False", "CompressedData = True\nCompressedDataSize = -1",
                        "CompressedDataSize: found \"-1\""},
                    Lie{"CompressedData = False", "CompressedData = True", "damaged gzip stream"}));

class ForeignRefusals : public Refusals {};

TEST_F(ForeignRefusals, CompressedMetaImagesOfAnotherLength) {
  for (const int bytes : {0, 47, 49, 20'000'000}) {
    const std::string data = gzipped(std::string(static_cast<std::size_t>(bytes), '\1'));
    const auto path = write("length.mha", metaHeader("CompressedData = False", "CompressedData = True") + data);
    expectInputError([&] { checkMetaImage(path, kLimit); }, "expected 48 as the header declares");
  }
  const std::string data = gzipped(std::string(48, '\1'));
  const auto path =
      write("cut.mha", metaHeader("CompressedData = False", "CompressedData = True") + data.substr(0, data.size() - 5));
  expectInputError([&] { checkMetaImage(path, kLimit); }, "the gzip stream is cut off");
}

TEST_F(ForeignRefusals, HeadersWithoutEnd) {
  expectInputError([&] { checkMetaImage(write("long.mha", std::string(1 << 20, 'a')), kLimit); }, "not a MetaImage");
  std::string keys;
  for (int i = 0; i < 20000; ++i)
    keys += fmt::format("key{} = value\n", i);
  expectInputError([&] { checkMetaImage(write("many.mha", keys), kLimit); }, "no ElementDataFile in the first");
  expectInputError([&] { checkMetaImage(write("empty.mha", ""), kLimit); }, "no ElementDataFile");
}

// --- NIfTI -----------------------------------------------------------------------------------------------------

std::string nifti() {
  return niftiHeader({4, 3, 2}, 4) + std::string(48, '\0');
}

struct NiftiLie {
  std::size_t place;
  std::vector<std::uint8_t> bytes;
  const char* says;
};
void PrintTo(const NiftiLie& lie, std::ostream* out) {
  *out << lie.place;
}

class NiftiLies : public Refusals, public testing::WithParamInterface<NiftiLie> {};
TEST_P(NiftiLies, AreOneLine) {
  std::string bytes = nifti();
  std::memcpy(bytes.data() + GetParam().place, GetParam().bytes.data(), GetParam().bytes.size());
  expectInputError([&] { checkNifti(write("lie.nii", bytes), kLimit); }, GetParam().says);
}
INSTANTIATE_TEST_SUITE_P(
    All, NiftiLies,
    testing::Values(NiftiLie{0, {1, 2, 3, 4}, "not NIfTI-1: the header's size"},
                    NiftiLie{40, {9, 0}, "dim[0]: found 9"}, NiftiLie{40, {0, 0}, "dim[0]: found 0"},
                    NiftiLie{42, {0xff, 0xff}, "dim[1]: found -1"}, NiftiLie{44, {0, 0}, "dim[2]: found 0"},
                    NiftiLie{42, {0xff, 0x7f, 0xff, 0x7f, 0xff, 0x7f}, "allowed: 4294967296 bytes in all"},
                    NiftiLie{42, {5, 0}, "expected 412 as the header declares"},
                    NiftiLie{70, {128, 0}, "datatype: found 128"}, NiftiLie{72, {8, 0}, "bitpix: found 8"},
                    NiftiLie{108, {0, 0, 0xc0, 0x7f}, "vox_offset: found nan"},
                    NiftiLie{108, {0, 0, 0x80, 0xbf}, "vox_offset: found -1"},
                    NiftiLie{344, {'n', 'i', '1'}, "not NIfTI-1 in one file: found \"ni1\""}));

TEST_F(ForeignRefusals, NiftiOfAnotherLength) {
  EXPECT_EQ(checkNifti(write("right.nii", nifti()), kLimit).bytes(), 48u);
  EXPECT_EQ(checkNifti(write("right.nii.gz", gzipped(nifti())), kLimit).bytes(), 48u);
  expectInputError([&] { checkNifti(write("short.nii", nifti().substr(0, 399)), kLimit); }, "found 399 bytes");
  expectInputError([&] { checkNifti(write("tiny.nii", nifti().substr(0, 100)), kLimit); }, "100 bytes, expected");
  expectInputError([&] { checkNifti(write("name.nii", gzipped(nifti())), kLimit); }, "found gzip data");
  expectInputError([&] { checkNifti(write("name.nii.gz", nifti()), kLimit); }, "found uncompressed data");
  expectInputError([&] { checkNifti(write("long.nii.gz", gzipped(nifti() + "x")), kLimit); }, "or more, expected 400");
  expectInputError([&] { checkNifti(write("short.nii.gz", gzipped(nifti().substr(0, 399))), kLimit); },
                   "are 399 bytes, expected 400");
}

// --- VTK -------------------------------------------------------------------------------------------------------

class VtkLies : public Refusals, public testing::WithParamInterface<Lie> {};
TEST_P(VtkLies, AreOneLine) {
  std::string text = "# vtk DataFile Version 3.0\ntitle\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 4 3 2\n"
                     "SPACING 1 1 1\nORIGIN 0 0 0\nPOINT_DATA 24\nSCALARS scalars short 1\nLOOKUP_TABLE default\n";
  const std::string changed = GetParam().changed;
  text.replace(text.find(changed), changed.size(), GetParam().by);
  const auto path = write("lie.vtk", text + std::string(48, '\1'));
  expectInputError([&] { checkVtk(path, kLimit); }, GetParam().says);
}
INSTANTIATE_TEST_SUITE_P(All, VtkLies,
                         testing::Values(Lie{"# vtk", "# kvt", "not a legacy VTK file"},
                                         Lie{"BINARY", "ASCII", "format: found \"ASCII\""},
                                         Lie{"STRUCTURED_POINTS", "POLYDATA", "DATASET: found \"POLYDATA\""},
                                         Lie{"4 3 2", "4 3 3", "found 48 bytes of voxels, expected 72"},
                                         Lie{"4 3 2", "-4 3 2", "DIMENSIONS: found \"-4\""},
                                         Lie{"4 3 2", "99999 99999 99999", "allowed: 4294967296 bytes in all"},
                                         Lie{"DIMENSIONS 4 3 2\n", "", "DIMENSIONS is missing"},
                                         Lie{"short 1", "short 3", "SCALARS: found"},
                                         Lie{"short", "bit", "SCALARS: found \"bit\""},
                                         Lie{"SCALARS scalars short 1", "VECTORS v short", "data: found \"VECTORS\""},
                                         Lie{"LOOKUP_TABLE", "LOOK", "after SCALARS: found \"LOOK\""}));

// --- DICOM -----------------------------------------------------------------------------------------------------

TEST_F(ForeignRefusals, DicomThatLies) {
  const auto refused = [&](const Dicom& dicom, const std::string& says) {
    SCOPED_TRACE(says);
    expectInputError([&] { checkDicom(write("lie.dcm", dicom.bytes), kLimit); }, says);
  };
  const std::string pixels(24, '\1');
  const auto whole = slice().longElement(0x7fe00010, "OW", 24, pixels);
  const DicomClaim claim = checkDicom(write("whole.dcm", whole.bytes), kLimit);
  EXPECT_EQ(claim.slice.dims, glm::ivec3(4, 3, 1));
  EXPECT_EQ(claim.series, "1.2.3.4");

  refused(slice(), "there are no pixels");
  refused(slice().longElement(0x7fe00010, "OW", 20, pixels), "found 20 bytes of pixels, expected 24");
  refused(slice().longElement(0x7fe00010, "OW", 24, "x"), "claims 24 bytes, more than the file has");
  refused(slice().longElement(0x00091000, "UN", 0x7fffffff, ""), "claims 2147483647 bytes, more than the file has");
  refused(slice().element(0x00280100, "US", Dicom::word(12)).longElement(0x7fe00010, "OW", 24, pixels),
          "found 12 bits allocated");
  refused(slice().element(0x00280002, "US", Dicom::word(3)).longElement(0x7fe00010, "OW", 24, pixels),
          "found 3 samples a pixel");
  refused(slice().element(0x00280008, "IS", "50").longElement(0x7fe00010, "OW", 24, pixels), "frames in one file");
  refused(slice().element(0x00280010, "US", Dicom::word(0)).longElement(0x7fe00010, "OW", 24, pixels), "0 rows");
  refused(slice().element(0x00280010, "US", Dicom::word(0xffff)).longElement(0x7fe00010, "OW", 24, pixels),
          "found 24 bytes of pixels, expected 524280");
  Dicom deep = slice();
  for (int i = 0; i < 40; ++i) {
    deep.longElement(0x00081115, "SQ", Dicom::kOpen, "");
    deep.bytes += Dicom::kOpenItem;
  }
  refused(deep, "sequences more than 16 deep");
  Dicom deflated;
  deflated.element(0x00020010, "UI", "1.2.840.10008.1.2.1.99").element(0x0020000e, "UI", "1.2");
  refused(deflated, "found the transfer syntax \"1.2.840.10008.1.2.1.99\", allowed: uncompressed, JPEG");
}

TEST_F(ForeignRefusals, DicomOfManySmallElements) {
  Dicom many = slice();
  many.longElement(0x00081115, "SQ", Dicom::kOpen, "");
  for (int item = 0; item < 20; ++item) {
    many.bytes += Dicom::kOpenItem;
    for (int i = 0; i < 20'000; ++i)
      many.element(0x00089999, "LO", "");
    many.bytes += Dicom::kItemEnd;
  }
  many.bytes += Dicom::kSequenceEnd;
  many.longElement(0x7fe00010, "OW", 24, std::string(24, '\1'));
  expectInputError([&] { checkDicom(write("many.dcm", many.bytes), kLimit); }, "more than 100000 elements");
}

TEST_F(ForeignRefusals, CompressedDicomThatLies) {
  const auto compressed = [](int side, std::uint32_t length, const std::string& pieces) {
    Dicom dicom;
    dicom.element(0x00020010, "UI", "1.2.840.10008.1.2.4.70")
        .element(0x00280010, "US", Dicom::word(static_cast<std::uint32_t>(side)))
        .element(0x00280011, "US", Dicom::word(static_cast<std::uint32_t>(side)))
        .element(0x00280100, "US", Dicom::word(16))
        .longElement(0x7fe00010, "OB", length, pieces);
    return dicom.bytes;
  };
  const auto refused = [&](const std::string& bytes, const std::string& says) {
    SCOPED_TRACE(says);
    expectInputError([&] { checkDicom(write("lie.dcm", bytes), kLimit); }, says);
  };
  const std::string pieces = Dicom::item(0, "") + Dicom::item(4, "abcd");
  EXPECT_EQ(
      checkDicom(write("whole.dcm", compressed(512, Dicom::kOpen, pieces + Dicom::kSequenceEnd)), kLimit).slice.dims.x,
      512);
  refused(compressed(512, 20, pieces), "compressed pixels that are not in pieces");
  refused(compressed(512, Dicom::kOpen, pieces), "the file ends within an element");
  refused(compressed(512, Dicom::kOpen, Dicom::item(0xfffffff0, "abcd")),
          "claims 4294967280 bytes, more than the file has");
  refused(compressed(512, Dicom::kOpen, pieces + "rubbish, not an item"), "something other than items");
  // 3 GiB of 32 bytes.
  refused(compressed(40'000, Dicom::kOpen, pieces + Dicom::kSequenceEnd), "too few for 40000 x 40000");
}

} // namespace
} // namespace volmark::test
