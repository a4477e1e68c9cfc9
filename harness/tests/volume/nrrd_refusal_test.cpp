// Truncated, lying and malicious NRRD files: each is one InputError, before memory of the declared size is asked for.
#include "volume/gzip_reader.h"
#include "volume/nrrd.h"
#include "volume/volume_files.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <ostream>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

namespace volmark::test {
namespace {

constexpr std::uint64_t kLimit = std::uint64_t(1) << 62;

struct Case {
  std::string name;
  std::string lines; ///< of the header after the magic
  std::string data;
  std::string message; ///< part of the error
};
void PrintTo(const Case& one, std::ostream* out) {
  *out << one.name;
}

std::string header(const std::string& sizes, const std::string& more = "", const std::string& encoding = "raw") {
  return fmt::format("type: uint8\ndimension: 3\nsizes: {}\nencoding: {}\n{}", sizes, encoding, more);
}

std::vector<Case> cases() {
  const std::string gzip = gzipped("abcdefgh");
  std::string badChecksum = gzip;
  badChecksum[badChecksum.size() - 6] ^= 1;
  return {
      {"NegativeSize", header("2 -2 2"), "abcdefgh", "field \"sizes\": found \"-2\""},
      {"ZeroSize", header("2 0 2"), "", "field \"sizes\": found \"0\""},
      {"HugeSize", header("2 99999999999999999999999 2"), "", "field \"sizes\": found \"999999"},
      {"FractionalSize", header("2 2.5 2"), "", "field \"sizes\": found \"2.5\""},
      {"WordAsSize", header("2 two 2"), "", "field \"sizes\": found \"two\""},
      {"TooFewSizes", header("2 2"), "", "allowed: 3 values"},
      {"TooManySizes", header("2 2 2 2"), "", "allowed: 3 values"},
      {"Terabytes", header("10000 10000 10000"), "abcdefgh", "found 8 bytes of voxels, expected 1000000000000"},
      {"TerabytesOfGzip", header("10000 10000 10000", "", "gzip"), gzip, "more than"},
      {"OverflowToZero", header("2147483647 2147483647 2147483647"), "", "allowed: 4611686018427387904 bytes"},
      {"OverflowToSmall", "type: uint8\ndimension: 4\nsizes: 65536 65536 65536 65536\nencoding: raw\n", "",
       "allowed: 4611686018427387904 bytes"},
      {"TooShort", header("2 2 2"), "abcdefg", "found 7 bytes of voxels, expected 8"},
      {"TooLong", header("2 2 2"), "abcdefghi", "found 9 bytes of voxels, expected 8"},
      {"GzipTooShort", header("2 2 2", "", "gzip"), gzipped("abcdefg"), "holds 7 bytes of voxels, expected 8"},
      {"GzipTooLong", header("2 2 2", "", "gzip"), gzipped("abcdefghi"), "holds more than the 8 bytes"},
      {"GzipCutOff", header("2 2 2", "", "gzip"), gzip.substr(0, gzip.size() - 9), "cut off"},
      {"GzipWithoutChecksum", header("2 2 2", "", "gzip"), gzip.substr(0, gzip.size() - 4), "cut off"},
      {"GzipBadChecksum", header("2 2 2", "", "gzip"), badChecksum, "damaged gzip stream"},
      {"GzipTrailingRubbish", header("2 2 2", "", "gzip"), gzip + "rubbish", "damaged gzip stream"},
      {"NotGzip", header("2 2 2", "", "gzip"), "abcdefghabcdefgh", "damaged gzip stream"},
      {"NoData", header("2 2 2", "", "gzip"), "", "more than 0 bytes of gzip"},
      {"HugeByteSkip", header("2 2 2", "byte skip: 9223372036854775807\n"), "abcdefgh", "found 0 bytes of voxels"},
      {"HugeByteSkipOfGzip", header("2 2 2", "byte skip: 9223372036854775807\n", "gzip"), gzip, "more than"},
      {"ByteSkipBeyondStream", header("2 2 2", "byte skip: 100\n", "gzip"), gzip, "ends within the 100 bytes to skip"},
      {"NegativeByteSkip", header("2 2 2", "byte skip: -2\n"), "abcdefgh", "field \"byte skip\": found \"-2\""},
      {"TooManyLines", header("2 2 2", "line skip: 9\n"), "abcd\nfgh", "more lines than there are in 8 bytes"},
      {"TwoDimensions", "type: uint8\ndimension: 2\nsizes: 2 2\nencoding: raw\n", "abcd",
       "field \"dimension\": found \"2\""},
      {"ManyDimensions", "type: uint8\ndimension: 999999999999\nsizes: 2 2\nencoding: raw\n", "",
       "field \"dimension\""},
      {"NoType", "dimension: 3\nsizes: 2 2 2\nencoding: raw\n", "abcdefgh", "field \"type\" is missing"},
      {"NoSizes", "type: uint8\ndimension: 3\nencoding: raw\n", "abcdefgh", "field \"sizes\" is missing"},
      {"NoEndian", "type: short\ndimension: 3\nsizes: 2 2 1\nencoding: raw\n", "abcdefgh",
       "field \"endian\" is missing"},
      {"BadEndian", "type: short\ndimension: 3\nsizes: 2 2 1\nencoding: raw\nendian: middle\n", "abcdefgh",
       "allowed: little, big"},
      {"Doubles", "type: double\ndimension: 3\nsizes: 1 1 1\nencoding: raw\nendian: little\n", "abcdefgh",
       "found \"double\", allowed: int8, uint8, int16, uint16, float"},
      {"Bzip2", header("2 2 2", "", "bzip2"), "abcdefgh", "found \"bzip2\", allowed: raw, gzip"},
      {"Misspelt", header("2 2 2", "spacing: 1 1 1\n"), "abcdefgh", "did you mean \"spacings\"?"},
      {"Twice", header("2 2 2", "sizes: 2 2 2\n"), "abcdefgh", "\"sizes\" stands there twice"},
      {"NoColon", header("2 2 2", "rubbish\n"), "abcdefgh", "header line \"rubbish\""},
      {"Colours", header("3 2 2", "kinds: RGB-color domain domain\n"), "abcdefghijkl",
       "field \"kinds\": found \"RGB-color\""},
      {"TimeFirst",
       "type: uint8\ndimension: 4\nsizes: 2 2 2 1\nencoding: raw\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n",
       "abcdefgh", "\"none\" for the fourth axis only"},
      {"ZeroSpacing", header("2 2 2", "spacings: 1 0 1\n"), "abcdefgh", "field \"spacings\": found \"0\""},
      {"InfiniteSpacing", header("2 2 2", "spacings: 1 inf 1\n"), "abcdefgh", "field \"spacings\": found \"inf\""},
      {"NegativeSpacing", header("2 2 2", "spacings: 1 -1 1\n"), "abcdefgh", "field \"spacings\": found \"-1\""},
      {"ZeroDirection", header("2 2 2", "space directions: (1,0,0) (0,0,0) (0,0,1)\n"), "abcdefgh", "lengths from"},
      {"OpenDirection", header("2 2 2", "space directions: (1,0,0) (0,1,0) (0,0,1\n"), "abcdefgh", "\")\" after every"},
      {"WordInDirection", header("2 2 2", "space directions: (1,0,0) (0,one,0) (0,0,1)\n"), "abcdefgh",
       "found \"one\""},
      {"List", header("2 2 2", "data file: LIST\n"), "", "lists and patterns of files are not read"},
      {"Pattern", header("2 2 2", "data file: slice%03d.raw 1 2 1\n"), "", "lists and patterns of files are not read"},
      {"MissingDataFile", header("2 2 2", "data file: absent.raw\n"), "", "absent.raw: no such file"},
      {"ControlCharacters", header("2 2 2", "\x1b[2J\x01: x\n"), "abcdefgh", "unknown field"},
      {"LongLine", header("2 2 2", std::string(5000, 'x') + ": y\n"), "abcdefgh", "unknown field"},
  };
}

class NrrdRefusal : public VolumeFiles, public testing::WithParamInterface<Case> {};

TEST_P(NrrdRefusal, IsOneQuickLine) {
  const auto path = write("bad.nrrd", "NRRD0004\n" + GetParam().lines + "\n" + GetParam().data);
  const auto start = std::chrono::steady_clock::now();
  rusage before{};
  rusage after{};
  getrusage(RUSAGE_SELF, &before);
  expectInputError([&] { loadNrrd(path, kLimit); }, GetParam().message);
  getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 64 * 1024) << "kilobytes";
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
}

INSTANTIATE_TEST_SUITE_P(Files, NrrdRefusal, testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name; });

class NrrdMemory : public Refusals {};

// 3 GB are declared, and 3 MB of gzip could hold them.
TEST_F(NrrdMemory, GrowsWithWhatTheStreamHolds) {
  const std::string lie = "NRRD0004\n" + header("2048 2048 700", "", "gzip") + "\n";
  expectInputError([&] { loadNrrd(write("noise.nrrd", lie + std::string(3'000'000, 'x')), kLimit); }, "damaged gzip");
  expectInputError(
      [&] { loadNrrd(writeSparse("short.nrrd", lie + gzipped(std::string(5'000'000, 'x')), 4'000'000), kLimit); },
      "damaged gzip");
}

// A terabyte of zeros without a line's end.
TEST_F(NrrdMemory, LinesAreLookedForInText) {
  const std::string lines = "NRRD0004\n" + header("2 2 2", "line skip: 1\n") + "\n";
  expectInputError([&] { loadNrrd(writeSparse("endless.nrrd", lines, std::uintmax_t(1) << 40), kLimit); },
                   "field \"line skip\": 1 more lines than there are in 1048576 bytes");
}

class NrrdFile : public VolumeFiles {};

// A disk that gives up in the middle.
TEST_F(NrrdFile, GzipThatCannotBeReadIsRefused) {
  ::alarm(20);                            // reading on and on is the error
  GzipReader reader("/proc/self/mem", 0); // no process can read its address 0
  std::vector<std::byte> bytes(10);
  expectInputError([&] { reader.read(bytes); }, "/proc/self/mem: the gzip stream is cut off");
  ::alarm(0);
}

TEST_F(NrrdFile, EveryPrefixIsRefused) {
  const std::string whole = "NRRD0004\n" + header("2 2 2", "spacings: 1 1 1\n", "gzip") + "\n" + gzipped("abcdefgh");
  EXPECT_NO_THROW(loadNrrd(write("whole.nrrd", whole), kLimit));
  for (std::size_t length = 0; length < whole.size(); ++length)
    expectInputError([&] { loadNrrd(write("part.nrrd", whole.substr(0, length)), kLimit); }, "part.nrrd");
}

TEST_F(NrrdFile, FlippedBitsNeverCrash) {
  const std::string whole = "NRRD0004\n" + header("2 2 2", "space directions: (1,0,0) (0,1,0) (0,0,1)\n", "gzip") +
                            "\n" + gzipped("abcdefgh");
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    std::string flipped = whole;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << (bit % 8)));
    try {
      EXPECT_EQ(loadNrrd(write("flipped.nrrd", flipped), kLimit)->timeSteps(), 1);
    } catch (const InputError&) {
    }
  }
}

TEST_F(NrrdFile, ForeignAndEndlessHeadersAreRefused) {
  const auto load = [&](const std::string& content) { loadNrrd(write("file.nrrd", content), kLimit); };
  expectInputError([&] { load("NRRD0006\n"); }, "starts with \"NRRD0006\", allowed: NRRD0001 to NRRD0005");
  expectInputError([&] { load(std::string("\x89PNG\r\n\x1a\n\0\0", 10)); }, "not an NRRD file");
  expectInputError([&] { load(""); }, "empty");
  std::string endless = "NRRD0004\n";
  while (endless.size() < 200000)
    endless += "# comment\n";
  expectInputError([&] { load(endless); }, "no end in its first 65536 bytes");
  expectInputError([&] { load("NRRD0004\n" + std::string(200000, 'x')); }, "no end in its first 65536 bytes");
}

TEST_F(NrrdFile, OtherThanRegularFilesAreRefused) {
  expectInputError([&] { loadNrrd(folder() / "absent.nrrd", kLimit); }, "absent.nrrd: no such file");
  expectInputError([&] { loadNrrd(folder(), kLimit); }, "not a regular file");
  const auto pipe = folder() / "pipe.nrrd";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expectInputError([&] { loadNrrd(pipe, kLimit); }, "not a regular file");
  const auto header = write("device.nhdr", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n"
                                           "data file: /dev/zero\n");
  expectInputError([&] { loadNrrd(header, kLimit); }, "/dev/zero: not a regular file");
}

TEST_F(NrrdFile, LimitIsInDecodedBytes) {
  const auto path = write("limit.nrrd", "NRRD0004\n" + header("2 2 2", "", "gzip") + "\n" + gzipped("abcdefgh"));
  EXPECT_NO_THROW(loadNrrd(path, 8));
  expectInputError([&] { loadNrrd(path, 7); }, "(8 bytes), allowed: 7 bytes");
}

} // namespace
} // namespace volmark::test
