#include "image/exr.h"
#include "volmark/error.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiView.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <random>
#include <unistd.h>

namespace volmark {

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

/// A folder of its own for each test.
class Exr : public testing::Test {
protected:
  void SetUp() override {
    m_folder = fs::temp_directory_path() / fmt::format("volmark_exr_{}_{}", getpid(),
                                                       testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(m_folder);
  }
  void TearDown() override { fs::remove_all(m_folder); }
  fs::path file(const char* name = "picture.exr") const { return m_folder / name; }

  fs::path m_folder;
};

/// Any half but NaN (infinities and denormals among them), any distance.
Picture randomPicture(unsigned seed, int width = 33, int height = 17) {
  std::mt19937 random(seed);
  Picture picture(width, height);
  for (glm::vec4& color : picture.color)
    for (int channel = 0; channel < 4; ++channel) {
      half value;
      do
        value.setBits(static_cast<unsigned short>(random()));
      while (value.isNan());
      color[channel] = value;
    }
  for (float& distance : picture.distance)
    distance = random() % 3 == 0 ? HUGE_VALF : static_cast<float>(random()) * 1e-3f;
  return picture;
}

/// The same with normals and steps.
Picture withLayers(Picture picture, unsigned seed) {
  std::mt19937 random(seed);
  for (std::size_t i = 0; i < picture.color.size(); ++i) {
    const auto next = [&] { return static_cast<float>(random()) * 1e-9f - 2; };
    picture.normal.emplace_back(next(), next(), next());
    picture.steps.push_back(static_cast<float>(random() % 1000));
  }
  return picture;
}

void expectSame(const Picture& a, const Picture& b) {
  ASSERT_EQ(a.width, b.width);
  ASSERT_EQ(a.height, b.height);
  EXPECT_EQ(std::memcmp(a.color.data(), b.color.data(), a.color.size() * sizeof(glm::vec4)), 0);
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.steps, b.steps);
}

std::string messageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

View someView(double x) {
  View view;
  view.pose = Pose::lookAt({x, 3, 8}, {0.5, 0, -1}, {0.1, 1, 0});
  view.frustum = {-0.3, 0.5, -0.2, 0.25};
  return view;
}

/// Where `world` lies in the picture, as shares of its width and height from the top left.
glm::dvec2 project(const View& view, const glm::dvec3& world) {
  const glm::dvec3 d = world - view.pose.position;
  const double depth = glm::dot(d, view.pose.forward);
  const Frustum& f = view.frustum;
  return {(glm::dot(d, view.pose.right) / depth - f.left) / (f.right - f.left),
          (f.up - glm::dot(d, view.pose.up) / depth) / (f.up - f.down)};
}

} // namespace

TEST_F(Exr, RoundTripIsBitExactInHalf) {
  const Picture picture = randomPicture(1);
  writeExr(file(), {picture}, {});
  const std::vector<Picture> read = readExr(file());
  ASSERT_EQ(read.size(), 1u);
  expectSame(read[0], picture);
}

TEST_F(Exr, StereoIsMultiView) {
  const std::vector<Picture> pictures = {randomPicture(1), randomPicture(2)};
  writeExr(file(), pictures, {"", "", {someView(0), someView(1)}});
  const std::vector<Picture> read = readExr(file());
  ASSERT_EQ(read.size(), 2u);
  expectSame(read[0], pictures[0]);
  expectSame(read[1], pictures[1]);

  const Imf::InputFile input(file().c_str());
  EXPECT_EQ(Imf::multiView(input.header()), (Imf::StringVector{"left", "right"}));
  for (const char* name : {"R", "G", "B", "A", "Z", "right.R", "right.G", "right.B", "right.A", "right.Z"})
    EXPECT_TRUE(input.header().channels().findChannel(name)) << name;
}

TEST_F(Exr, LayersAreKeptBitForBit) {
  const Picture both = withLayers(randomPicture(1), 2);
  Picture stepsOnly = both;
  stepsOnly.normal.clear();
  Picture normalOnly = both;
  normalOnly.steps.clear();
  normalOnly.distance.clear();
  for (const Picture& picture : {both, stepsOnly, normalOnly}) {
    writeExr(file(), {picture}, {});
    expectSame(readExr(file())[0], picture);
    const Imf::InputFile input(file().c_str());
    for (const char* name : {"N.X", "N.Y", "N.Z"})
      EXPECT_EQ(input.header().channels().findChannel(name) != nullptr, !picture.normal.empty()) << name;
    EXPECT_EQ(input.header().channels().findChannel("steps") != nullptr, !picture.steps.empty());
  }
}

// OpenEXR puts the view before the last part of a name; a name with a dot belongs to no view without it.
TEST_F(Exr, LayersOfBothEyesBelongToTheirViews) {
  const std::vector<Picture> pictures = {withLayers(randomPicture(1), 3), withLayers(randomPicture(2), 4)};
  writeExr(file(), pictures, {});
  const std::vector<Picture> read = readExr(file());
  expectSame(read.at(0), pictures[0]);
  expectSame(read.at(1), pictures[1]);

  const Imf::InputFile input(file().c_str());
  const Imf::StringVector views = Imf::multiView(input.header());
  const auto namesIn = [&](const std::string& view) {
    std::vector<std::string> names;
    const Imf::ChannelList list = Imf::channelsInView(view, input.header().channels(), views);
    for (auto channel = list.begin(); channel != list.end(); ++channel)
      names.emplace_back(channel.name());
    return names;
  };
  EXPECT_THAT(namesIn("left"),
              testing::UnorderedElementsAre("R", "G", "B", "A", "Z", "N.left.X", "N.left.Y", "N.left.Z", "steps"));
  EXPECT_THAT(namesIn("right"), testing::UnorderedElementsAre("right.R", "right.G", "right.B", "right.A", "right.Z",
                                                              "N.right.X", "N.right.Y", "N.right.Z", "right.steps"));
}

TEST_F(Exr, ColoursAreRoundedToTheNearestHalf) {
  Picture picture(2, 1);
  picture.color = {{0.1f, 1.0004f, 1.0006f, 1e6f}, {0, 0, 0, 0}};
  writeExr(file(), {picture}, {});
  const glm::vec4 read = readExr(file())[0].color[0];
  EXPECT_NEAR(read.r, 0.1f, 0.1f / 2048);
  EXPECT_EQ(read.g, 1.0f);
  EXPECT_EQ(read.b, 1.0f + 1.0f / 1024);
  EXPECT_EQ(read.a, HUGE_VALF);
}

TEST_F(Exr, DistancesAreLeftOutWhereThereAreNone) {
  Picture picture = randomPicture(3);
  picture.distance.clear();
  writeExr(file(), {picture}, {});
  EXPECT_TRUE(readExr(file())[0].distance.empty());
  EXPECT_FALSE(Imf::InputFile(file().c_str()).header().channels().findChannel("Z"));
}

TEST_F(Exr, AttributesSayWhereItComesFrom) {
  writeExr(file(), {randomPicture(1)}, {"0123456789abcdef0123456789abcdef", "frame 7", {someView(2)}});
  const Imf::InputFile input(file().c_str());
  const Imf::Header& header = input.header();
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("volmark.run").value(), "0123456789abcdef0123456789abcdef");
  EXPECT_EQ(header.typedAttribute<Imf::IntAttribute>("volmark.format").value(), 1);
  EXPECT_EQ(Imf::comments(header), "frame 7");
  EXPECT_EQ(header.compression(), Imf::ZIP_COMPRESSION);
}

TEST_F(Exr, EmptyAttributesAreLeftOut) {
  writeExr(file(), {randomPicture(1)}, {});
  const Imf::InputFile input(file().c_str());
  EXPECT_FALSE(input.header().findTypedAttribute<Imf::StringAttribute>("volmark.run"));
  EXPECT_FALSE(Imf::hasComments(input.header()));
  EXPECT_FALSE(Imf::hasWorldToCamera(input.header()));
}

TEST_F(Exr, MatricesMultiplyRowVectors) {
  const std::vector<View> views = {someView(-1), someView(1)};
  writeExr(file(), {randomPicture(1), randomPicture(2)}, {"", "", views});
  const Imf::InputFile input(file().c_str());
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string prefix = i == 0 ? "" : "right.";
    const View& view = views[i];
    const auto& camera = input.header().typedAttribute<Imf::M44fAttribute>(prefix + "worldToCamera").value();
    const auto& ndc = input.header().typedAttribute<Imf::M44fAttribute>(prefix + "worldToNDC").value();
    for (const glm::dvec3& point : {glm::dvec3(0), glm::dvec3(1, -2, 0.5), glm::dvec3(-1, 1, 2)}) {
      const Imath::V3f world(float(point.x), float(point.y), float(point.z));
      const glm::dvec3 d = point - view.pose.position;
      const Imath::V3f inCamera = world * camera;
      EXPECT_NEAR(inCamera.x, glm::dot(d, view.pose.right), 1e-5);
      EXPECT_NEAR(inCamera.y, glm::dot(d, view.pose.up), 1e-5);
      EXPECT_NEAR(inCamera.z, glm::dot(d, view.pose.forward), 1e-5);
      // V3f * M44f divides by w.
      const Imath::V3f inPicture = world * ndc;
      EXPECT_NEAR(inPicture.x, project(view, point).x, 1e-5);
      EXPECT_NEAR(inPicture.y, project(view, point).y, 1e-5);
      EXPECT_NEAR(inPicture.z, 1 / glm::dot(d, view.pose.forward), 1e-5);
    }
    EXPECT_NE(ndc.determinant(), 0);
  }
}

TEST_F(Exr, NothingButThePictureIsLeft) {
  writeExr(file(), {randomPicture(1)}, {});
  writeExr(file(), {randomPicture(2)}, {});
  expectSame(readExr(file())[0], randomPicture(2));
  EXPECT_EQ(std::distance(fs::directory_iterator(m_folder), fs::directory_iterator()), 1);
}

TEST_F(Exr, UnwritablePlacesGiveOneLine) {
  const fs::path absent = m_folder / "absent" / "picture.exr";
  const fs::path occupied = m_folder / "occupied.exr";
  fs::create_directories(occupied / "something");
  for (const fs::path& path : {absent, occupied}) {
    const std::string message = messageOf([&] { writeExr(path, {randomPicture(1)}, {}); });
    EXPECT_THAT(message, HasSubstr(path.string() + ": picture can't be written: "));
    EXPECT_THAT(message, Not(HasSubstr("\n")));
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(m_folder), fs::directory_iterator()), 1);
}

TEST_F(Exr, TruncatedFilesGiveOneLine) {
  writeExr(file(), {randomPicture(1, 64, 64)}, {"run", "", {someView(0)}});
  const auto size = fs::file_size(file());
  for (const double share : {0.999, 0.7, 0.1, 0.02, 0.0}) {
    fs::copy_file(file(), file("cut.exr"), fs::copy_options::overwrite_existing);
    fs::resize_file(file("cut.exr"), static_cast<std::uintmax_t>(share * static_cast<double>(size)));
    const std::string message = messageOf([&] { readExr(file("cut.exr")); });
    EXPECT_THAT(message, HasSubstr("cut.exr: picture can't be read: ")) << share;
    EXPECT_THAT(message, Not(HasSubstr("\n")));
  }
}

TEST_F(Exr, OtherFilesAreRefused) {
  EXPECT_THAT(messageOf([&] { readExr(file("absent.exr")); }), HasSubstr("absent.exr: picture can't be read: "));

  std::ofstream(file("text.exr")) << "not a picture at all, but long enough to be a header of one";
  EXPECT_THAT(messageOf([&] { readExr(file("text.exr")); }), HasSubstr("text.exr: picture can't be read: "));

  // An OpenEXR file without our attribute, then with a later version, then without channels.
  const auto writeHeader = [&](int version) {
    Imf::Header header(1, 1);
    if (version > 0) header.insert("volmark.format", Imf::IntAttribute(version));
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    half pixel = 0;
    Imf::FrameBuffer frame;
    frame.insert("Y", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(&pixel), sizeof(half), sizeof(half)));
    Imf::OutputFile output(file().c_str(), header);
    output.setFrameBuffer(frame);
    output.writePixels(1);
  };
  writeHeader(0);
  EXPECT_THAT(messageOf([&] { readExr(file()); }), HasSubstr("no attribute volmark.format"));
  writeHeader(2);
  EXPECT_THAT(messageOf([&] { readExr(file()); }), HasSubstr("volmark.format is 2, allowed: 1"));
  writeHeader(1);
  EXPECT_THAT(messageOf([&] { readExr(file()); }), HasSubstr("channel R is missing"));
}

// Another program's view of the file.
TEST_F(Exr, ExrheaderReadsIt) {
  if (std::system("command -v exrheader > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "exrheader (package openexr) is absent";
  writeExr(file(), {withLayers(randomPicture(1), 3), withLayers(randomPicture(2), 4)},
           {"abcdef", "frame 7", {someView(0), someView(1)}});
  const std::string command = fmt::format("exrheader '{}'", file().string());
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  ASSERT_TRUE(pipe);
  for (int character; (character = std::fgetc(pipe)) != EOF;)
    text += static_cast<char>(character);
  EXPECT_EQ(pclose(pipe), 0);
  for (const char* expected :
       {"R, 16-bit floating-point", "right.A, 16-bit floating-point", "right.Z, 32-bit floating-point",
        "N.left.X, 32-bit floating-point", "N.right.Z, 32-bit floating-point", "right.steps, 32-bit floating-point",
        "zip, multi-scanline blocks", "abcdef", "frame 7", "worldToCamera", "worldToNDC", "multiView"})
    EXPECT_THAT(text, HasSubstr(expected));
}

} // namespace volmark
