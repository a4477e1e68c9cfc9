// Scenario documents: merging, errors in place, expansion.
#include "tests/scenario/scenario_files.h"

namespace volmark::test {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> labelsOf(const Scenario& scenario) {
  std::vector<std::string> rows;
  for (const Point& point : scenario.points) {
    std::string row;
    for (const Label& label : point.labels)
      row += (row.empty() ? "" : " ") + label.axis + "=" + label.value;
    rows.push_back(row);
  }
  return rows;
}

// --- Order of merging ----------------------------------------------------------------------------------------

TEST_F(ScenarioTest, LaterLayersWin) {
  write("profiles/small.json", R"({"volmark": 1, "description": "of the profile",
    "set": {"pacing.frames": 3, "pacing.orbits": 3, "pacing.warm_up_frames": 13, "measure": {"seed": 3}}})");
  const std::string text = R"("description": "of the file",
    "set": {"scene": "blob", "technique": {"name": "march_a"},
            "pacing": {"frames": 2, "orbits": 2, "warm_up_frames": 12}, "measure.seed": 2, "measure.interleave": 2},
    "profiles": {"small": {"set": {"pacing": {"frames": 4, "orbits": 4}}}})";
  const auto pacing = [](const Scenario& scenario) {
    const PointSettings& s = scenario.points.at(0).settings;
    return std::vector<int>{s.pacing.frames,     s.pacing.orbits,      s.pacing.warmUpFrames,
                            int(s.measure.seed), s.measure.interleave, s.measure.replicates};
  };
  EXPECT_THAT(pacing(read(text)), ElementsAre(2, 2, 12, 2, 2, 1));
  EXPECT_THAT(pacing(read(text, "small")), ElementsAre(4, 4, 13, 3, 2, 1));
  EXPECT_THAT(pacing(read(text, "small", {"pacing.frames=5"})), ElementsAre(5, 4, 13, 3, 2, 1));
  EXPECT_THAT(pacing(read(text, "small", {"pacing.frames=5", "pacing.frames=6"})), ElementsAre(6, 4, 13, 3, 2, 1));
  EXPECT_EQ(read(text, "small").description, "of the file");
  EXPECT_EQ(read(text, "small").document.count("profiles"), 0u);
}

TEST_F(ScenarioTest, NullForgets) {
  write("profiles/p.json", R"({"volmark": 1, "set": {"pacing": null, "camera.fov_degrees": null}})");
  const std::string text =
      R"("set": {"scene": "blob", "technique.name": "march_a", "pacing.frames": 7, "camera.fov_degrees": 50},
    "blocks": [{"axes": {"case": {"values": [{"label": "x", "set": {}}]}}}, {"set": {"pacing": null}}])";
  const Scenario plain = read(text);
  EXPECT_EQ(plain.points[0].settings.pacing.frames, 7);
  EXPECT_EQ(plain.points[1].settings.pacing.frames, 60);
  const Scenario patched = read(text, "p");
  EXPECT_EQ(patched.points[0].settings.pacing.frames, 60);
  EXPECT_EQ(patched.points[0].settings.camera.verticalFovDegrees, 30);
}

TEST_F(ScenarioTest, ProfilesPatchBlocksByNumber) {
  const std::string text = std::string(kBlob) + R"(,
    "blocks": [{"axes": {"step": {"path": "technique.parameters.step", "values": [0.5, 1, 2]}}},
               {"set": {"technique.name": "march_b"}}],
    "profiles": {"one": {"blocks": {"0": {"axes": {"step": {"values": [1]}}}}},
                 "none": {"blocks": [{}]}, "bad": {"blocks": {"2": {}}}})";
  EXPECT_EQ(read(text).points.size(), 4u);
  EXPECT_THAT(labelsOf(read(text, "one")), ElementsAre("technique=march_a step=1", "technique=march_b"));
  EXPECT_EQ(read(text, "none").points.size(), 1u);
  EXPECT_THAT(errorOf(text, "bad"), HasSubstr("found number 2, allowed: 0 to 1"));
}

TEST_F(ScenarioTest, PatchedSetsReplaceWholeValues) {
  const Scenario scenario =
      read(R"("set": {"scene": "blob", "technique.name": "march_a", "isovalue": {"normalized": 0.5}},
              "profiles": {"p": {"set": {"isovalue": {"raw": 3}}}})",
           "p");
  EXPECT_EQ(scenario.points[0].config["isovalue"], json::parse(R"({"raw": 3.0})"));
}

// --- Assignments ---------------------------------------------------------------------------------------------

TEST_F(ScenarioTest, AssignmentsWinOverBlocks) {
  const std::string text = R"("set": {"scene": "blob"},
    "blocks": [{"set": {"technique.name": "march_a", "resolution": [100, 100]},
                "axes": {"step": {"path": "technique.parameters.step", "values": [0.5, 1]},
                         "case": {"values": [{"label": "b", "set": {"isovalue": "bone"}}]}}}])";
  const Scenario wide = read(text, "", {"resolution=[200, 10]"});
  ASSERT_EQ(wide.points.size(), 2u);
  for (const Point& point : wide.points)
    EXPECT_EQ(point.settings.width, 200);
  EXPECT_THAT(labelsOf(read(text, "", {"technique.parameters.step=0.25"})),
              ElementsAre("technique=march_a step=0.25 case=b"));
  EXPECT_THAT(labelsOf(read(text, "", {"blocks.0.axes.step.values=[2, 3, 4]"})),
              ElementsAre("technique=march_a step=2 case=b", "technique=march_a step=3 case=b",
                          "technique=march_a step=4 case=b"));
  EXPECT_EQ(read(text, "", {"limits.pixels=100"}).points[0].settings.width, 10);
  EXPECT_THAT(errorOf(text, "", {"isovalue=skin"}), HasSubstr("--set isovalue=skin: the axis \"case\" sets it too"));
  EXPECT_THAT(errorOf(text, "", {"technique.parameters.step=9"}), HasSubstr("step: found 9, allowed: number"));
  EXPECT_EQ(errorOf(text, "", {"frames=9"}).substr(0, 40), "--set frames=9: unknown key \"frames\", al");
}

// --- Expansion -----------------------------------------------------------------------------------------------

TEST_F(ScenarioTest, TheLastAxisVariesFastestInTheOrderOfTheFile) {
  const Scenario scenario = read(R"("set": {"scene": "blob", "technique.name": "march_a"},
    "blocks": [{"axes": {"zoom": {"path": "camera.distance", "values": [100, "fit"]},
                         "case": {"values": [{"label": "low", "set": {"isovalue": "skin", "pacing.frames": 10}},
                                             {"label": "high", "set": {"isovalue": "bone", "pacing": {"frames": 20}}}]},
                         "a": {"path": "technique.parameters.step", "values": [1.0]}}},
               {"set": {"technique.name": "march_b"}, "axes": {"fast": {"path": "technique.parameters.fast", "values": [true, false]}}}])");
  EXPECT_THAT(scenario.axes, ElementsAre("technique", "zoom", "case", "a", "fast"));
  EXPECT_THAT(labelsOf(scenario),
              ElementsAre("technique=march_a zoom=100 case=low a=1.0", "technique=march_a zoom=100 case=high a=1.0",
                          "technique=march_a zoom=fit case=low a=1.0", "technique=march_a zoom=fit case=high a=1.0",
                          "technique=march_b fast=true", "technique=march_b fast=false"));
  for (std::size_t i = 0; i < scenario.points.size(); ++i)
    EXPECT_EQ(scenario.points[i].index, int(i));
  EXPECT_EQ(scenario.points[1].settings.pacing.frames, 20);
  EXPECT_EQ(scenario.points[1].settings.isovalue->value, 0.7);
  EXPECT_EQ(scenario.points[3].settings.camera.distanceMm, std::nullopt);
  EXPECT_EQ(scenario.points[4].block, 1);
}

TEST_F(ScenarioTest, CountIsTheProductOfTheAxes) {
  for (int a : {1, 2, 5})
    for (int b : {1, 3, 4}) {
      json values_a = json::array(), values_b = json::array();
      for (int i = 0; i < a; ++i)
        values_a.push_back(i + 1);
      for (int i = 0; i < b; ++i)
        values_b.push_back(i + 1);
      const json axes = {{"a", {{"path", "measure.seed"}, {"values", values_a}}},
                         {"b", {{"path", "pacing.frames"}, {"values", values_b}}}};
      const Scenario scenario = read(std::string(kBlob) + ", \"blocks\": [{\"axes\": " + axes.dump() + "}]");
      ASSERT_EQ(scenario.points.size(), std::size_t(a * b));
      for (int i = 0; i < a * b; ++i) {
        EXPECT_EQ(int(scenario.points[i].settings.measure.seed), i / b + 1);
        EXPECT_EQ(scenario.points[i].settings.pacing.frames, i % b + 1);
      }
    }
}

TEST_F(ScenarioTest, TheAxisTechniqueMayBeWrittenOut) {
  const Scenario scenario = read(R"("set": {"scene": "blob"},
    "blocks": [{"axes": {"seed": {"path": "measure.seed", "values": [1, 2]},
                         "technique": {"path": "technique.name", "values": ["march_a", "march_b"]}}}])");
  EXPECT_THAT(scenario.axes, ElementsAre("technique", "seed"));
  EXPECT_THAT(labelsOf(scenario), ElementsAre("technique=march_a seed=1", "technique=march_b seed=1",
                                              "technique=march_a seed=2", "technique=march_b seed=2"));
  EXPECT_EQ(scenario.points[0].group, scenario.points[1].group);
  EXPECT_NE(scenario.points[0].group, scenario.points[2].group);
  EXPECT_THAT(
      errorOf(std::string(kBlob) + R"(, "blocks": [{"axes": {"technique": {"path": "measure.seed", "values": [1]}}}])"),
      HasSubstr("/blocks/0/axes/technique: the axis \"technique\" is for technique.name"));
}

TEST_F(ScenarioTest, PointsNeedDifferentLabels) {
  EXPECT_THAT(errorOf(std::string(kBlob) + R"(, "blocks": [{}, {"set": {"pacing.frames": 3}}])"),
              HasSubstr("two points (blocks 0 and 1) have the same labels: technique march_a"));
  EXPECT_NO_THROW(read(std::string(kBlob) + R"(, "blocks": [{}, {"set": {"technique.name": "march_b"}}])"));
}

TEST_F(ScenarioTest, HugeGridsAreRefusedBeforeTheyAreMade) {
  json values = json::array();
  for (int i = 0; i < 1000; ++i)
    values.push_back(i);
  const json axis = {{"path", "measure.seed"}, {"values", values}};
  json axes;
  for (int i = 0; i < 26; ++i)
    axes[std::string(1, char('a' + i))] = axis;
  EXPECT_THAT(errorOf(std::string(kBlob) + ", \"blocks\": [{\"axes\": " + axes.dump() + "}]"),
              HasSubstr("/blocks/0: found over 100000 points, allowed: 100000"));
}

// --- Errors in place -----------------------------------------------------------------------------------------

TEST_F(ScenarioTest, ErrorsNameFileAndPointer) {
  const std::string blob = kBlob;
  const std::pair<std::string, const char*> cases[] = {
      {R"("set": {"pacing": {"frames": "ten"}})",
       "a.json: /set/pacing/frames: found \"ten\", allowed: integer 1 to 100000"},
      {R"("set": {"pacing": {"frame": 10}})", "a.json: /set/pacing: unknown key \"frame\", did you mean \"frames\"?"},
      {R"("sett": {})", "a.json: unknown key \"sett\", did you mean \"set\"?"},
      {R"("blocks": [])", "a.json: /blocks: found [], allowed: at least one block"},
      {R"("blocks": [3])", "a.json: /blocks/0: found 3, allowed: object"},
      {R"("blocks": [{"axis": {}}])", "a.json: /blocks/0: unknown key \"axis\", did you mean \"axes\"?"},
      {R"("blocks": [{"axes": {"a": {}}}])", "a.json: /blocks/0/axes/a: key \"values\" is missing"},
      {R"("blocks": [{"axes": {"a": {"path": "measure.seed", "values": []}}}])",
       "a.json: /blocks/0/axes/a/values: found [], allowed: at least one value"},
      {R"("blocks": [{"axes": {"a": {"path": "measure.sed", "values": [1]}}}])",
       "a.json: /blocks/0/axes/a/path: unknown key \"measure.sed\", did you mean \"seed\"? allowed in measure: "},
      {R"("blocks": [{"axes": {"a": {"path": "measure.seed", "values": [1, "x"]}}}])",
       "a.json: /blocks/0/axes/a/values/1: found \"x\", allowed: integer 0 to"},
      {R"("blocks": [{"axes": {"a": {"values": [1]}}}])",
       "a.json: /blocks/0/axes/a/values/0: found 1, allowed: {\"label\", \"set\"}, because the axis has no \"path\""},
      {R"("blocks": [{"axes": {"a": {"values": [{"label": "x"}]}}}])",
       "a.json: /blocks/0/axes/a/values/0: key \"set\" is missing"},
      {R"("blocks": [{"axes": {"a b": {"values": [1]}}}])", "a.json: /blocks/0/axes: found name \"a b\", allowed: "},
      {R"("limits": {"pixels": 0})", "a.json: /limits/pixels: found 0, allowed: integer 1 to"},
      {R"("limits": {"pixel": 10})", "a.json: /limits: unknown key \"pixel\", did you mean \"pixels\"?"},
      {R"("profiles": {"p": {"set": {"resolution": 3}}})",
       "a.json: /profiles/p/set/resolution: found 3, allowed: array"},
      {R"("set": {"technique.name": "march_a"})", "a.json: key \"scene\" is missing"},
      {R"("set": {"scene": "blob"}, "blocks": [{}])", "a.json: /blocks/0: key \"technique.name\" is missing"},
      {blob + R"(, "blocks": [{"axes": {"s": {"path": "technique.parameters.step", "values": [1, 9]}}}])",
       "a.json: /blocks/0/axes/s/values/1: technique \"march_a\": step: found 9, allowed: number 0.01 to 4 voxel"},
      {blob + R"(, "title": 3)", "a.json: /title: found 3, allowed: text"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_THAT(errorOf(text), HasSubstr(message)) << text;
}

TEST_F(ScenarioTest, VersionsAndNamesAreChecked) {
  const auto refusal = [&](const std::string& text) {
    try {
      readFile(write("b.json", text));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal(R"({"volmark": 2, "name": "b"})"),
              HasSubstr("b.json: /volmark: found 2, allowed: integer 1 to 1"));
  EXPECT_THAT(refusal(R"({"name": "b"})"), HasSubstr("b.json: key \"volmark\" is missing"));
  EXPECT_THAT(refusal(R"({"volmark": 1, "name": "../b"})"), HasSubstr("b.json: /name: found name \"../b\", allowed:"));
  EXPECT_THAT(refusal(R"({"volmark": 1, "name": "b",})"), HasSubstr("b.json: line 1, column 28: malformed JSON"));
  EXPECT_THAT(refusal(R"({"volmark": 1, "name": "b", "name": "c"})"), HasSubstr("b.json: key \"name\" stands twice"));
  EXPECT_THAT(refusal("[]"), HasSubstr("b.json: found [], allowed: object"));
}

TEST_F(ScenarioTest, ProfilesAreCheckedInTheirOwnFile) {
  write("profiles/bad.json", R"({"volmark": 1, "set": {"resolution": "tiny"}})");
  write("profiles/old.json", R"({"set": {}})");
  write("profiles/smoke.json", R"({"volmark": 1})");
  EXPECT_THAT(errorOf(kBlob, "bad"), HasSubstr("profiles/bad.json: /set/resolution: found \"tiny\", allowed: array"));
  EXPECT_THAT(errorOf(kBlob, "old"), HasSubstr("profiles/old.json: key \"volmark\" is missing"));
  EXPECT_EQ(errorOf(std::string(kBlob) + R"(, "profiles": {"own": {}})", "smok"),
            "a.json: unknown profile \"smok\", did you mean \"smoke\"? allowed: \"bad\", \"old\", \"own\", \"smoke\"");
}

// --- Limits --------------------------------------------------------------------------------------------------

TEST_F(ScenarioTest, LimitsKeepTheAspect) {
  for (const auto& [width, height] :
       {std::pair(512, 512), std::pair(1920, 1080), std::pair(10000, 1), std::pair(3, 16000)})
    for (const int limit : {1, 100, 65536, 3000000}) {
      const Scenario scenario = read(std::string(kBlob) + R"(, "limits": {"pixels": )" + std::to_string(limit) + "}",
                                     "", {"resolution=[" + std::to_string(width) + "," + std::to_string(height) + "]"});
      const PointSettings& s = scenario.points[0].settings;
      EXPECT_LE(s.width * s.height, limit);
      EXPECT_GE(std::min(s.width, s.height), 1);
      if (width * height <= limit) {
        EXPECT_EQ(std::pair(s.width, s.height), std::pair(width, height));
      }
      if (std::min(s.width, s.height) >= 50) {
        EXPECT_NEAR(double(s.width) / s.height, double(width) / height, 0.05);
      }
      EXPECT_EQ(scenario.points[0].config["resolution"], json({s.width, s.height}));
    }
}

TEST_F(ScenarioTest, GeneratedVolumesShrinkButStayAsLarge) {
  for (const int limit : {8, 100, 5000, 1000000}) {
    const Scenario scenario = read(std::string(kBlob) + R"(, "limits": {"voxels": )" + std::to_string(limit) + "}");
    const PointSettings& s = scenario.points[0].settings;
    const GeneratorSettings& g = std::get<GeneratorSource>(s.scene.source).settings;
    EXPECT_LE(g.dims.x * g.dims.y * g.dims.z, limit);
    EXPECT_GE(std::min({g.dims.x, g.dims.y, g.dims.z}), 2);
    const glm::dvec3 extent = Grid{g.dims, g.spacingMm}.extentMm();
    EXPECT_NEAR(extent.x, 40, 1e-9);
    EXPECT_NEAR(extent.y, 60, 1e-9);
    EXPECT_NEAR(extent.z, 30, 1e-9);
    EXPECT_EQ(scenario.points[0].config["volume"]["generator"]["dims"], json({g.dims.x, g.dims.y, g.dims.z}));
    EXPECT_EQ(s.maximumVoxels, limit);
  }
}

TEST_F(ScenarioTest, FramesAreLimitedAndShown) {
  const Scenario scenario = read(std::string(kBlob) + R"(, "limits": {"frames": 24})");
  EXPECT_EQ(scenario.points[0].config["pacing"]["frames"], 24);
  EXPECT_EQ(read(std::string(kBlob) + R"(, "limits": {"frames": 240})").points[0].config["pacing"]["frames"], 60);
}

} // namespace
} // namespace volmark::test
