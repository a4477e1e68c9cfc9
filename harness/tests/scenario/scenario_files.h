// A folder of small scenes and profiles, and techniques without modules, for tests of scenarios.
#pragma once

#include "scenario/scenario.h"
#include "volmark/error.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace volmark::test {

inline TechniqueFactory fakeTechnique(const std::string& name, Draws draws,
                                      std::vector<ParameterDescriptor> parameters) {
  TechniqueFactory factory;
  factory.info.name = name;
  factory.info.draws = draws;
  factory.info.shadings = {ShadingModel::lambert, ShadingModel::phong};
  factory.info.shadows = true;
  factory.info.functionBeyond = true;
  factory.info.segments = true;
  factory.info.parameters = std::move(parameters);
  return factory;
}

/// march_a and march_b draw isosurfaces with different parameters; integrate draws volumes, one view, unshaded, no
/// shadows.
inline const TechniqueCatalogue& techniques() {
  static const TechniqueFactory a =
      fakeTechnique("march_a", Draws::isosurface,
                    {ParameterDescriptor::number("step", 0.5, 0.01, 4, "voxel", "Step length."),
                     ParameterDescriptor::integer("bisections", 6, 0, 16, "", "Refinements."),
                     ParameterDescriptor::choice("filtering", "hardware", {"hardware", "shader"}, "Who filters.")});
  static const TechniqueFactory b =
      fakeTechnique("march_b", Draws::isosurface, {ParameterDescriptor::boolean("fast", true, "Takes a short cut.")});
  static const TechniqueFactory c = [] {
    TechniqueFactory factory = fakeTechnique(
        "integrate", Draws::volume, {ParameterDescriptor::number("step", 1, 0.01, 4, "voxel", "Step length.")});
    factory.info.shadings = {ShadingModel::none};
    factory.info.maximumViews = 1;
    factory.info.shadows = false;
    factory.info.functionBeyond = false;
    return factory;
  }();
  static const TechniqueCatalogue catalogue = [] {
    TechniqueCatalogue result;
    result.add(a, "march");
    result.add(b, "march");
    result.add(c, "integrate");
    return result;
  }();
  return catalogue;
}

/// Removed at the end of the test.
class ScenarioTest : public ::testing::Test {
protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    m_folder = std::filesystem::path(::testing::TempDir()) /
               (std::string("volmark_") + std::to_string(::getpid()) + "_" + info->name());
    std::filesystem::create_directories(m_folder / "scenes");
    std::filesystem::create_directories(m_folder / "profiles");
    write("scenes/blob.json", R"({"volmark_scene": 1, "title": "Blob",
      "volume": {"generator": {"name": "marschner_lobb", "dims": [41, 31, 21], "spacing_mm": [1, 2, 1.5], "type": "uint8"}},
      "isovalues": {"skin": {"normalized": 0.4}, "bone": {"normalized": 0.7}},
      "transfer_functions": {"soft": {"points": [{"value": 0.25, "color": [1, 0.5, 0], "opacity": 0},
                                                 {"value": 0.75, "color": [1, 1, 1], "opacity": 0.5}]},
                             "hard": {"points": [{"value": 0.5, "color": [1, 1, 1], "opacity": 0.9}]}}})");
    write("scenes/bare.json", R"({"volmark_scene": 1, "title": "Bare", "volume": {"file": "bare.nrrd"}})");
  }
  void TearDown() override { std::filesystem::remove_all(m_folder); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(m_folder / name) << text;
    return m_folder / name;
  }

  Scenario readFile(const std::filesystem::path& file, const std::string& profile = "",
                    std::vector<std::string> assignments = {}) const {
    return readScenario({file, profile, std::move(assignments), m_folder / "scenes", m_folder / "profiles"},
                        techniques());
  }

  /// `text`: a scenario without its first two keys.
  Scenario read(const std::string& text, const std::string& profile = "",
                std::vector<std::string> assignments = {}) const {
    return readFile(write("a.json", R"({"volmark": 1, "name": "a", )" + text + "}"), profile, std::move(assignments));
  }

  std::string errorOf(const std::string& text, const std::string& profile = "",
                      std::vector<std::string> assignments = {}) const {
    try {
      read(text, profile, std::move(assignments));
    } catch (const InputError& error) {
      std::string message = error.what();
      EXPECT_THAT(message, ::testing::Not(::testing::HasSubstr("\n")));
      const std::string folder = m_folder.string() + "/";
      for (std::size_t at; (at = message.find(folder)) != std::string::npos;)
        message.erase(at, folder.size());
      return message;
    }
    ADD_FAILURE() << "no InputError";
    return "";
  }

  std::filesystem::path m_folder;
};

inline constexpr const char* kBlob = R"("set": {"scene": "blob", "technique.name": "march_a"})";

} // namespace volmark::test
