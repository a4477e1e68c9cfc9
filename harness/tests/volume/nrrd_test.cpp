#include "volume/nrrd.h"
#include "volume/volume_files.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <type_traits>

namespace volmark::test {
namespace {

constexpr std::uint64_t kNoLimit = std::uint64_t(1) << 40;

/// Small distinct values with both extremes of the type.
template <class T> std::vector<T> sampleValues(std::size_t count) {
  std::vector<T> values(count);
  for (std::size_t i = 0; i < count; ++i)
    values[i] = static_cast<T>(static_cast<double>(i) * 1.5 - (std::is_signed_v<T> ? 20 : 0));
  values.front() = std::numeric_limits<T>::lowest();
  values.back() = std::numeric_limits<T>::max();
  return values;
}

struct Spelling {
  const char* text;
  ScalarType type;
};
void PrintTo(const Spelling& spelling, std::ostream* out) {
  *out << spelling.text;
}

class NrrdTypes : public VolumeFiles, public testing::WithParamInterface<Spelling> {
protected:
  /// Writes all combinations of byte order, encoding and attachment and reads each back.
  template <class T> void roundTrip() {
    const std::vector<T> values = sampleValues<T>(4 * 3 * 2);
    for (const bool bigEndian : {false, true})
      for (const bool gzip : {false, true})
        for (const bool detached : {false, true}) {
          const std::string name = fmt::format("big{:d}_gzip{:d}_detached{:d}", bigEndian, gzip, detached);
          SCOPED_TRACE(name);
          std::string data = encoded(values, bigEndian);
          if (gzip) data = gzipped(data);
          std::string header =
              fmt::format("NRRD0004\n# comment\ntype: {}\ndimension: 3\nsizes: 4 3 2\nspacings: 1 2 0.5\n"
                          "encoding: {}\nendian: {}\n",
                          GetParam().text, gzip ? "gzip" : "raw", bigEndian ? "big" : "little");
          if (detached) {
            write(name + ".data", data);
            header += fmt::format("data file: {}.data\n", name);
          }
          const auto path = write(name + ".nrrd", detached ? header : header + "\n" + data);
          expectValues(*loadNrrd(path, kNoLimit), values);
        }
  }

  template <class T> void expectValues(const Volume& volume, const std::vector<T>& values) {
    ASSERT_EQ(volume.grid().dims, glm::ivec3(4, 3, 2));
    EXPECT_EQ(volume.grid().spacingMm, glm::dvec3(1, 2, 0.5));
    EXPECT_EQ(volume.type(), GetParam().type);
    ASSERT_EQ(volume.voxels().size(), values.size() * sizeof(T));
    EXPECT_EQ(std::memcmp(volume.voxels().data(), values.data(), volume.voxels().size()), 0);
    EXPECT_EQ(volume.value(1, 2, 1), static_cast<double>(values[1 + 4 * (2 + 3 * 1)]));
  }
};

TEST_P(NrrdTypes, ComeBackInBothByteOrdersEncodingsAndAttachments) {
  switch (GetParam().type) {
  case ScalarType::int8: return roundTrip<std::int8_t>();
  case ScalarType::uint8: return roundTrip<std::uint8_t>();
  case ScalarType::int16: return roundTrip<std::int16_t>();
  case ScalarType::uint16: return roundTrip<std::uint16_t>();
  case ScalarType::float32: return roundTrip<float>();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Spellings, NrrdTypes,
    testing::Values(Spelling{"signed char", ScalarType::int8}, Spelling{"int8", ScalarType::int8},
                    Spelling{"int8_t", ScalarType::int8}, Spelling{"uchar", ScalarType::uint8},
                    Spelling{"unsigned char", ScalarType::uint8}, Spelling{"uint8", ScalarType::uint8},
                    Spelling{"uint8_t", ScalarType::uint8}, Spelling{"short", ScalarType::int16},
                    Spelling{"short int", ScalarType::int16}, Spelling{"signed short", ScalarType::int16},
                    Spelling{"signed short int", ScalarType::int16}, Spelling{"int16", ScalarType::int16},
                    Spelling{"int16_t", ScalarType::int16}, Spelling{"ushort", ScalarType::uint16},
                    Spelling{"unsigned short", ScalarType::uint16}, Spelling{"unsigned short int", ScalarType::uint16},
                    Spelling{"uint16", ScalarType::uint16}, Spelling{"uint16_t", ScalarType::uint16},
                    Spelling{"float", ScalarType::float32}, Spelling{"FLOAT", ScalarType::float32}));

class Nrrd : public VolumeFiles {
protected:
  /// A valid 2 x 2 x 2 uint8 file with more header lines.
  std::filesystem::path writeWith(const std::string& lines, const std::string& data = "abcdefgh") const {
    return write("with.nrrd",
                 "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n" + lines + "\n" + data);
  }
  glm::dvec3 spacingWith(const std::string& lines) const {
    return loadNrrd(writeWith(lines), kNoLimit)->grid().spacingMm;
  }
};

TEST_F(Nrrd, ReadsEveryMagicUpTo5) {
  for (int version = 1; version <= 5; ++version)
    EXPECT_EQ(
        loadNrrd(write("v.nrrd",
                       fmt::format("NRRD000{}\ntype: uint8\ndimension: 3\nsizes: 1 1 1\nencoding: raw\n\nx", version)),
                 kNoLimit)
            ->value(0, 0, 0),
        'x');
}

TEST_F(Nrrd, IgnoresWhatDoesNotBearOnVoxels) {
  const auto volume = loadNrrd(
      writeWith("content: a: b := c\r\nspace: left-posterior-superior\nkinds: domain domain domain\n"
                "space origin: (0,0,0)\ncenterings: cell cell cell\nlabels: \"x\" \"y\" \"z\"\nunits: \"mm\" \"mm\" "
                "\"mm\"\nold min: 0\noldmax: 255\n# type: float\nkey: with colon:=value\nsizes:=9 9 9\n"),
      kNoLimit);
  EXPECT_EQ(volume->value(0, 0, 0), 'a');
  EXPECT_EQ(volume->value(1, 1, 1), 'h');
  EXPECT_EQ(volume->grid().spacingMm, glm::dvec3(1));
}

TEST_F(Nrrd, SpacingIsThatOfTheHeader) {
  EXPECT_EQ(spacingWith(""), glm::dvec3(1));
  EXPECT_EQ(spacingWith("spacings: 0.5 2 3e-1\n"), glm::dvec3(0.5, 2, 0.3));
  EXPECT_EQ(spacingWith("spacings: NaN 2 nan\n"), glm::dvec3(1, 2, 1));
  EXPECT_EQ(spacingWith("space directions: (0.5,0,0) (0, -2, 0) (0,0,3)\n"), glm::dvec3(0.5, 2, 3));
  const glm::dvec3 rotated = spacingWith("space directions: (3,4,0)(-4,3,0) (0,0,2)\nspacings: 9 9 9\n");
  EXPECT_NEAR(glm::length(rotated - glm::dvec3(5, 5, 2)), 0, 1e-12);
}

// The same patient, whatever space the directions are written in.
TEST_F(Nrrd, SpacesDifferInTheSignsOfTheirAxes) {
  const std::map<std::string, glm::ivec3> spaces = {
      {"left-posterior-superior", {1, 1, 1}},        {"LPS", {1, 1, 1}},
      {"right-anterior-superior", {-1, -1, 1}},      {"RAS", {-1, -1, 1}},
      {"left-anterior-superior", {1, -1, 1}},        {"las", {1, -1, 1}},
      {"Right-Anterior-Superior-Time", {-1, -1, 1}}, {"RAST", {-1, -1, 1}},
      {"left-anterior-superior-time", {1, -1, 1}},   {"LAST", {1, -1, 1}},
  };
  glm::ivec3 order{0, 1, 2};
  do
    for (int flips = 0; flips < 8; ++flips) {
      std::string identity;
      for (const auto& [space, signs] : spaces) {
        SCOPED_TRACE(fmt::format("{} {}{}{} {}", space, order.x, order.y, order.z, flips));
        const bool time = space.ends_with('T') || space.ends_with("ime");
        std::string lines = fmt::format("space: {}\nspace directions:", space);
        for (int axis = 0; axis < 3; ++axis) {
          glm::ivec3 direction(0);
          direction[order[axis]] = (flips >> axis & 1 ? -1 : 1) * signs[order[axis]] * (axis + 1);
          lines += fmt::format(" ({},{},{})", direction.x, direction.y, direction.z);
        }
        const auto volume =
            loadNrrd(write("space.nrrd", fmt::format("NRRD0005\ntype: uint8\ndimension: {}\nsizes: 2 3 4{}\nencoding: "
                                                     "raw\n{}{}\n\nabcdefghijklmnopqrstuvwx",
                                                     time ? 4 : 3, time ? " 1" : "", lines, time ? " none" : "")),
                     kNoLimit);
        if (identity.empty()) identity = volume->identity();
        EXPECT_EQ(volume->identity(), identity);
        // Axis 0 of the file points left where it is not flipped.
        const bool upwards = volume->value(0, 0, 0) < volume->value(1, 0, 0);
        EXPECT_TRUE(order.x != 0 || upwards == ((flips & 1) == 0));
      }
    }
  while (std::next_permutation(&order[0], &order[0] + 3));
}

TEST_F(Nrrd, FourthAxisIsTime) {
  for (const std::string lines : {"kinds: domain domain domain time\nspacings: 1 2 3 nan\n",
                                  "space directions: (1,0,0) (0,2,0) (0,0,3) none\n"}) {
    const auto path =
        write("time.nrrd", "NRRD0005\ntype: uint8\ndimension: 4\nsizes: 2 1 1 3\nencoding: raw\n" + lines + "\nabcdef");
    const auto volume = loadNrrd(path, kNoLimit);
    EXPECT_EQ(volume->timeSteps(), 3);
    EXPECT_EQ(volume->grid().dims, glm::ivec3(2, 1, 1));
    EXPECT_EQ(volume->grid().spacingMm, glm::dvec3(1, 2, 3));
    EXPECT_EQ(volume->value(1, 0, 0, 2), 'f');
  }
}

TEST_F(Nrrd, SkipsLinesAndBytes) {
  EXPECT_EQ(loadNrrd(writeWith("line skip: 2\nbyte skip: 3\n", "one\ntwo\n...abcdefgh"), kNoLimit)->value(0, 0, 0),
            'a');
  EXPECT_EQ(loadNrrd(writeWith("byteskip: -1\n", "whatever abcdefgh"), kNoLimit)->value(0, 0, 0), 'a');
  // In a compressed stream lines are skipped before and bytes after decoding.
  const auto path = write("skip.nrrd", "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: gz\nline skip: 1\n"
                                       "byte skip: 2\n\nline\n" +
                                           gzipped("..abcdefgh"));
  EXPECT_EQ(loadNrrd(path, kNoLimit)->value(1, 1, 1), 'h');
}

TEST_F(Nrrd, ReadsGzipInSeveralMembers) {
  const auto path = write("members.nrrd", "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: gzip\n\n" +
                                              gzipped("abc") + gzipped("") + gzipped("defgh"));
  EXPECT_EQ(loadNrrd(path, kNoLimit)->value(1, 1, 1), 'h');
}

TEST_F(Nrrd, LargeGzipIsReadInBlocks) {
  std::string voxels(100 * 100 * 100, '\0');
  for (std::size_t i = 0; i < voxels.size(); ++i)
    voxels[i] = static_cast<char>((i * 2654435761u) >> 13);
  const auto path = write("large.nrrd", "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 100 100 100\nencoding: gzip\n\n" +
                                            gzipped(voxels));
  const auto volume = loadNrrd(path, kNoLimit);
  EXPECT_EQ(std::memcmp(volume->voxels().data(), voxels.data(), voxels.size()), 0);
}

TEST_F(Nrrd, ConstantAndFlatVolumesLoad) {
  const auto constant = loadNrrd(writeWith("", "aaaaaaaa"), kNoLimit);
  EXPECT_EQ(constant->dataRange().minimum, 'a');
  EXPECT_EQ(constant->dataRange().maximum, 'a');
  const auto flat = loadNrrd(
      write("flat.nrrd", "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 1 4 1\nencoding: raw\n\nabcd"), kNoLimit);
  EXPECT_EQ(flat->grid().extentMm(), glm::dvec3(0, 3, 0));
  EXPECT_EQ(flat->value(0, 3, 0), 'd');
}

TEST_F(Nrrd, RefusesNonFiniteVoxels) {
  for (const float bad :
       {std::nanf(""), std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()}) {
    const auto path =
        write("bad.nrrd", "NRRD0005\ntype: float\ndimension: 3\nsizes: 2 1 1\nencoding: raw\nendian: big\n\n" +
                              encoded(std::vector<float>{1, bad}, true));
    expectInputError([&] { loadNrrd(path, kNoLimit); }, "voxel (1, 0, 0)");
  }
}

} // namespace
} // namespace volmark::test
