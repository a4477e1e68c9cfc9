#include "scenario/scene_file.h"
#include "volmark/error.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace volmark {
namespace {

const std::filesystem::path kScenes = std::filesystem::path(VOLMARK_SOURCE_DIR) / "scenes";
constexpr std::uint64_t kNoLimit = std::uint64_t(1) << 40;

const char* const kWhole = R"({
  "volmark_scene": 1, "title": "A title", "volume": {"file": "v.nrrd"},
  "source": {"package": "some-package", "package_file": "/usr/share/v", "url": "http://example.org/v",
             "raw": {"dims": [4, 3, 2], "type": "uint8", "spacing_mm": [1, 1, 2]}, "license": "CC0", "acknowledgement": "them", "note": "a part",
             "sha512": "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"},
  "visualisation_range": [-1000, 2000],
  "isovalues": {"skin": {"raw": -400}, "bone": {"raw": 300}, "air": {"normalized": 0.1}},
  "transfer_functions": {"z": {"points": [{"value": 0.1, "color": [1, 0.5, 0], "opacity": 0}, {"value": 0.1, "color": [1, 1, 1], "opacity": 1}]},
                         "a": {"points": [{"value": 0, "color": [0, 0, 0], "opacity": 0.25}]}},
  "framing": {"up": [0, 0, 2], "front": [0, -1, 0]},
  "light": {"direction": [0, 3, 4], "color": [1, 0.9, 0.8], "spot": true, "distance": 2.5, "ambient": 0.2}})";

class SceneFile : public testing::Test {
protected:
  SceneFile() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    m_folder = std::filesystem::path(testing::TempDir()) / fmt::format("volmark_SceneFile_{}", info->name());
    std::filesystem::remove_all(m_folder);
    std::filesystem::create_directories(m_folder / "data");
  }
  ~SceneFile() override { std::filesystem::remove_all(m_folder); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(m_folder / name, std::ios::binary) << text;
    return m_folder / name;
  }
  SceneDescription read(const std::string& text) const { return readScene(write("scene.json", text)); }

  /// kWhole after an RFC 7396 merge with a patch.
  std::string patched(const std::string& patch) const {
    nlohmann::json document = nlohmann::json::parse(kWhole);
    document.merge_patch(nlohmann::json::parse(patch));
    return document.dump();
  }
  template <class Action> void expectError(Action action, const std::vector<std::string>& parts) const {
    try {
      action();
      ADD_FAILURE() << "no error with " << parts.front();
    } catch (const InputError& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
      for (const std::string& part : parts)
        EXPECT_NE(text.find(part), std::string::npos) << "no \"" << part << "\" in: " << text;
    }
  }
  void expectRefused(const std::string& patch, const std::vector<std::string>& parts) const {
    expectError([&] { read(patched(patch)); }, parts);
  }

  std::filesystem::path m_folder;
};

TEST_F(SceneFile, ReadsEveryKey) {
  const SceneDescription scene = read(kWhole);
  EXPECT_EQ(scene.name, "scene");
  EXPECT_EQ(scene.title, "A title");
  EXPECT_EQ(std::get<FileSource>(scene.source).file, "v.nrrd");
  EXPECT_EQ(scene.license, "CC0");
  EXPECT_EQ(scene.fetchHint, "scenes/fetch.py scene");
  EXPECT_EQ(scene.visualisationRange->minimum, -1000);
  EXPECT_EQ(scene.visualisationRange->maximum, 2000);
  EXPECT_EQ(scene.framing.up, glm::dvec3(0, 0, 1));
  EXPECT_EQ(scene.framing.front, glm::dvec3(0, -1, 0));
  EXPECT_FALSE(scene.light.headlight);
  EXPECT_NEAR(glm::length(scene.light.direction - glm::dvec3(0, 0.6, 0.8)), 0, 1e-12);
  EXPECT_EQ(scene.light.color, glm::dvec3(1, 0.9, 0.8));
  EXPECT_EQ(scene.light.ambient, 0.2);
  EXPECT_TRUE(scene.light.spot);
  EXPECT_EQ(scene.light.distance, 2.5);
  EXPECT_EQ(scene.document.at("title"), "A title");
}

TEST_F(SceneFile, NamedEntriesKeepTheFilesOrder) {
  const SceneDescription scene = read(kWhole);
  ASSERT_EQ(scene.isovalues.size(), 3u);
  EXPECT_EQ(scene.isovalues[0].first, "skin");
  EXPECT_EQ(scene.isovalues[1].first, "bone");
  EXPECT_EQ(scene.isovalues[2].first, "air");
  EXPECT_TRUE(scene.isovalues[0].second.raw);
  EXPECT_EQ(scene.isovalues[0].second.value, -400);
  EXPECT_FALSE(scene.isovalues[2].second.raw);
  ASSERT_EQ(scene.transferFunctions.size(), 2u);
  EXPECT_EQ(scene.transferFunctions[0].first, "z");
  EXPECT_EQ(scene.transferFunctions[0].second.name(), "z");
  EXPECT_EQ(scene.transferFunctions[0].second.points()[0].color, glm::dvec3(1, 0.5, 0));
  EXPECT_EQ(scene.transferFunctions[1].second.points()[0].opacity, 0.25);
}

TEST_F(SceneFile, WhatIsAbsentHasADefault) {
  const SceneDescription scene = read(R"({"volmark_scene": 1, "title": "t", "volume": {"file": "v.nrrd"}})");
  EXPECT_FALSE(scene.visualisationRange);
  ASSERT_EQ(scene.isovalues.size(), 1u);
  EXPECT_EQ(scene.isovalues[0].second.value, 0.5);
  ASSERT_EQ(scene.transferFunctions.size(), 1u);
  EXPECT_EQ(scene.transferFunctions[0].first, "ramp");
  EXPECT_TRUE(scene.light.headlight);
  EXPECT_EQ(scene.framing.up, glm::dvec3(0, 1, 0));
  EXPECT_TRUE(scene.fetchHint.empty());
}

TEST_F(SceneFile, RefusesWhatItDoesNotKnow) {
  expectRefused(R"({"isovalue": {}})", {"scene.json", "\"isovalue\"", "isovalues"});
  expectRefused(R"({"volmark_scene": 2})", {"/volmark_scene", "found 2"});
  expectRefused(R"({"title": null})", {"\"title\" is missing"});
  expectRefused(R"({"volume": null})", {"\"volume\" is missing"});
  expectRefused(R"({"volume": {"generator": {}}})", {"/volume", "exactly one of"});
  expectRefused(R"({"volume": {"file": null}})", {"/volume", "exactly one of"});
  expectRefused(R"({"source": {"sha512": "12ab"}})", {"/source/sha512", "128 hexadecimal digits"});
  expectRefused(R"({"source": {"licence": "CC0"}})", {"/source", "licence", "license"});
  expectRefused(R"({"source": {"package": null}})", {"/source", "\"package\" and \"package_file\", or neither"});
  expectRefused(R"({"source": {"package_file": null}})", {"/source", "\"package\" and \"package_file\", or neither"});
  expectRefused(R"({"source": {"package_file": "v"}})", {"/source/package_file", "found \"v\"", "absolute path"});
  expectRefused(R"({"source": {"url": null}})", {"/source", "\"raw\" describes the file at \"url\""});
  expectRefused(R"({"source": {"raw": {"dims": [4, 3]}}})", {"/source/raw/dims", "[x, y, z]"});
  expectRefused(R"({"source": {"raw": {"type": "float64"}}})", {"/source/raw/type", "float32"});
  expectRefused(R"({"source": {"raw": {"file": "v.raw"}}})", {"/source/raw", "file"});
  expectRefused(R"({"visualisation_range": [5, 5]})", {"/visualisation_range", "smallest < largest"});
  expectRefused(R"({"isovalues": {"bone": {"normalized": 0.5}}})", {"/isovalues/bone"});
  expectRefused(R"({"isovalues": {"bone": {"raw": null, "normalized": 1.5}}})", {"/isovalues/bone/normalized", "1.5"});
  expectRefused(R"({"isovalues": {"skin": null, "bone": null, "air": null}})", {"/isovalues", "at least one"});
  expectRefused(R"({"isovalues": [1]})", {"/isovalues", "object"});
  expectRefused(R"({"framing": {"front": [0, 0, 1]}})", {"/framing", "orthogonal"});
  expectRefused(R"({"framing": {"up": [0, 0, 0]}})", {"/framing/up", "direction"});
  expectRefused(R"({"light": {"ambient": 2}})", {"/light/ambient", "found 2"});
  expectRefused(R"({"light": {"direction": null, "headlight": false}})", {"/light", "\"direction\" is missing"});
  expectRefused(R"({"light": {"direction": null, "headlight": null, "spot": true}})", {"/light", "a spotlight needs"});
  expectRefused(R"({"light": {"distance": 1}})", {"/light/distance", "found 1"});
  expectRefused(R"({"labels": {}})", {"/labels", "one of \"file\" and \"generator\""});
  expectRefused(R"({"labels": {"generator": "phantom_labels"}})", {"/labels/generator", "generated volume"});
}

TEST_F(SceneFile, RefusesWrongTransferFunctions) {
  expectRefused(R"({"transfer_functions": {"a": {"points": []}}})", {"/transfer_functions/a/points", "at least one"});
  expectRefused(R"({"transfer_functions": {"a": {"points": [{"value": 2, "color": [0, 0, 0], "opacity": 0}]}}})",
                {"/transfer_functions/a/points/0/value", "found 2"});
  expectRefused(R"({"transfer_functions": {"a": {"points": [{"value": 0.5, "color": [0, 0, 0], "opacity": 0},
                                                             {"value": 0.4, "color": [0, 0, 0], "opacity": 0}]}}})",
                {"/transfer_functions/a/points/1/value", "at least 0.5"});
  expectRefused(R"({"transfer_functions": {"a": {"points": [{"value": 0.5, "color": [0, 0], "opacity": 0}]}}})",
                {"/transfer_functions/a/points/0/color", "3"});
  expectRefused(R"({"transfer_functions": {"a": {"points": [{"value": 0.5, "colour": [0, 0, 0], "opacity": 0}]}}})",
                {"/transfer_functions/a/points/0", "color"});
}

TEST_F(SceneFile, ReadsGenerators) {
  const auto generator = [&](const std::string& more) {
    return read(
        R"({"volmark_scene": 1, "title": "t", "volume": {"generator": {"name": "marschner_lobb", "dims": [4, 5, 6])" +
        more + "}}}");
  };
  const SceneDescription scene = generator(R"(, "spacing_mm": [1, 2, 3], "type": "float32", "parameters": {"f_m": 3})");
  const auto& settings = std::get<GeneratorSource>(scene.source).settings;
  EXPECT_EQ(settings.dims, glm::ivec3(4, 5, 6));
  EXPECT_EQ(settings.spacingMm, glm::dvec3(1, 2, 3));
  EXPECT_EQ(settings.type, ScalarType::float32);
  EXPECT_EQ(settings.parameters.at("f_m"), 3);
  EXPECT_EQ(openVolume(scene, {}, kNoLimit)->voxels().size(), 480u);
  expectError([&] { openVolume(scene, {}, 479); }, {"scene scene", "(480 bytes), allowed: 479 bytes"});
  EXPECT_FALSE(findVolumeFile(scene, {}));

  expectError([&] { generator(R"(, "parameters": {"fm": 3})"); }, {"/volume/generator/parameters", "f_m"});
  expectError([&] { generator(R"(, "parameters": {"f_m": -3})"); }, {"/volume/generator/parameters", "found -3"});
  expectError([&] { generator(R"(, "type": "float64")"); }, {"/volume/generator/type", "float32"});
  expectError([&] { generator(R"(, "spacing_mm": [1, 0, 1])"); }, {"/volume/generator/spacing_mm/1"});
  expectError([&] { generator(R"(, "seed": 1)"); }, {"/volume/generator", "seed"});
}

TEST_F(SceneFile, TimeStepsOfGeneratorsCountAgainstMemory) {
  const SceneDescription scene = read(R"({"volmark_scene": 1, "title": "t", "volume": {"generator":
    {"name": "blast_wave", "dims": [4, 5, 6], "parameters": {"time_steps": 3}}}})");
  EXPECT_EQ(openVolume(scene, {}, 360)->timeSteps(), 3);
  expectError([&] { openVolume(scene, {}, 359); }, {"scene scene", "3 time steps (360 bytes), allowed: 359 bytes"});
}

TEST_F(SceneFile, LabelsAreGeneratedOrRead) {
  const auto labelled = [&](const std::string& labels) {
    return read(R"({"volmark_scene": 1, "title": "t", "volume": {"generator":
      {"name": "phantom", "dims": [6, 5, 4], "type": "float32"}}, "labels": )" +
                labels + "}");
  };
  const auto volume = openVolume(labelled(R"({"generator": "phantom_labels"})"), {}, kNoLimit);
  ASSERT_TRUE(volume->labels());
  EXPECT_EQ(volume->labels()->grid().dims, glm::ivec3(6, 5, 4));
  EXPECT_EQ(volume->labels()->type(), ScalarType::uint8);

  const std::string header = "NRRD0004\ntype: uint8\ndimension: 3\nencoding: raw\nsizes: ";
  const SceneDescription byFile = labelled(R"({"file": "labels.nrrd"})");
  expectError([&] { openVolume(byFile, {}, kNoLimit); }, {"there is no labels.nrrd"});
  write("labels.nrrd", header + "6 5 4\n\n" + std::string(120, '\x7f'));
  const auto read = openVolume(byFile, {}, kNoLimit);
  EXPECT_EQ(read->labels()->value(3, 2, 1), 127);
  EXPECT_NE(read->identity(), volume->identity());
  write("labels.nrrd", header + "6 5 4\n\n" + std::string(120, '\x80'));
  expectError([&] { openVolume(byFile, {}, kNoLimit); }, {"labels of type uint8 up to 128", "uint8 and 127"});
  write("labels.nrrd", header + "5 6 4\n\n" + std::string(120, '\1'));
  expectError([&] { openVolume(byFile, {}, kNoLimit); }, {"labels of 5 x 6 x 4 voxels", "6 x 5 x 4"});
}

TEST_F(SceneFile, FilesAreLookedForBesideTheSceneThenInOrder) {
  const SceneDescription scene = read(R"({"volmark_scene": 1, "title": "t", "source": {"url": "http://example.org/v"},
    "volume": {"raw": {"file": "v.raw", "dims": [2, 1, 1], "type": "uint16", "endian": "big", "offset_bytes": 1,
               "spacing_mm": [3, 2, 1], "time_steps": 2}}})");
  std::filesystem::create_directories(m_folder / "more");
  const DataFolders data{{m_folder / "data", m_folder / "more"}};
  expectError([&] { openVolume(scene, data, kNoLimit); },
              {"scene scene: there is no v.raw in ", (m_folder / "data").string(), (m_folder / "more").string(),
               "to get it: scenes/fetch.py scene"});
  const auto firstVoxel = [&] { return openVolume(scene, data, kNoLimit)->value(0, 0, 0); };
  write("more/v.raw", std::string("x\0\3\0\0\0\0\0\0", 9));
  EXPECT_EQ(firstVoxel(), 3);
  write("data/v.raw", std::string("x\0\2\0\0\0\0\0\0", 9));
  EXPECT_EQ(firstVoxel(), 2);
  write("v.raw", std::string("x\0\1\0\0\0\0\0\7", 9));
  EXPECT_EQ(firstVoxel(), 1);
  const auto volume = openVolume(scene, data, kNoLimit);
  EXPECT_EQ(volume->value(1, 0, 0, 1), 7);
  EXPECT_EQ(volume->grid().spacingMm, glm::dvec3(3, 2, 1));
  expectError([&] { openVolume(scene, data, 7); }, {"v.raw", "allowed: 7 bytes"});
}

TEST_F(SceneFile, BareVolumeFilesMakeAScene) {
  const auto path = write("bare.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 1 1\nencoding: raw\n\nab");
  const SceneDescription scene = sceneForFile(path);
  EXPECT_EQ(scene.name, "bare");
  EXPECT_TRUE(scene.path.empty());
  EXPECT_EQ(scene.isovalues.at(0).second.value, 0.5);
  EXPECT_EQ(scene.transferFunctions.at(0).first, "ramp");
  EXPECT_EQ(openVolume(scene, {}, kNoLimit)->value(1, 0, 0), 'b');
  expectError([&] { openVolume(sceneForFile(m_folder / "absent.nrrd"), {}, kNoLimit); }, {"absent.nrrd"});
  expectError([&] { openVolume(sceneForFile(write("v.dcm", "x")), {}, kNoLimit); }, {"v.dcm", ".nrrd, .nhdr"});
}

std::vector<std::filesystem::path> shippedScenes() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(kScenes))
    if (entry.path().extension() == ".json") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

DataFolders dataFolders() {
  DataFolders data;
  const char* folders = std::getenv("VOLMARK_DATA");
  std::istringstream list(folders ? folders : "");
  for (std::string folder; std::getline(list, folder, ':');)
    data.folders.push_back(folder);
  data.folders.push_back(kScenes / "data");
  return data;
}

TEST(ShippedScenes, AreThere) {
  EXPECT_GE(shippedScenes().size(), 3u);
}

class ShippedScene : public testing::TestWithParam<std::filesystem::path> {};

INSTANTIATE_TEST_SUITE_P(All, ShippedScene, testing::ValuesIn(shippedScenes()),
                         [](const auto& test) { return test.param.stem().string(); });

/// Isovalues and the kinks of transfer functions lie where there is data.
TEST_P(ShippedScene, FitsItsVolume) {
  const SceneDescription scene = readScene(GetParam());
  if (!std::holds_alternative<GeneratorSource>(scene.source)) {
    EXPECT_TRUE(scene.document.at("source").contains("acknowledgement"));
    EXPECT_TRUE(scene.document.at("source").contains("sha512"));
    if (!findVolumeFile(scene, dataFolders()))
      GTEST_SKIP() << "no volume file: VOLMARK_DATA and scenes/data don't have it";
  }
  const auto volume = openVolume(scene, dataFolders(), kNoLimit);
  const Range data = volume->dataRange();
  const Range shown = scene.visualisationRange.value_or(data);
  EXPECT_LT(shown.minimum, data.maximum);
  EXPECT_GT(shown.maximum, data.minimum);
  for (const auto& [name, isovalue] : scene.isovalues) {
    const double raw = isovalue.raw ? isovalue.value : shown.minimum + isovalue.value * (shown.maximum - shown.minimum);
    EXPECT_GT(raw, std::max(data.minimum, shown.minimum)) << name;
    EXPECT_LT(raw, std::min(data.maximum, shown.maximum)) << name;
  }
}

} // namespace
} // namespace volmark
