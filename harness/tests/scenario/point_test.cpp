// One point: defaults, canonical configuration, what does not fit together.
#include "scenario/point_keys.h"
#include "tests/scenario/scenario_files.h"

namespace volmark::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class PointTest : public ScenarioTest {
protected:
  Point make(json set, std::vector<std::string> assignments = {}) const {
    if (!set.contains("scene")) set["scene"] = "blob";
    if (!set.contains("technique.name") && !set.contains("technique")) set["technique.name"] = "march_a";
    return makePoint(set, assignments, techniques(), m_folder / "scenes");
  }
  json configOf(const json& set) const { return make(set).config; }

  std::string refusal(const json& set, std::vector<std::string> assignments = {}) const {
    try {
      make(set, std::move(assignments));
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "no InputError for " << set;
    return "";
  }
};

TEST_F(PointTest, HasAllDefaults) {
  const Point point = make({});
  const PointSettings& s = point.settings;
  EXPECT_EQ(s.width, 512);
  EXPECT_EQ(s.camera.verticalFovDegrees, 30);
  EXPECT_EQ(s.pacing.frames, 60);
  EXPECT_EQ(s.parameters.number("step"), 0.5);
  EXPECT_EQ(s.shading.model, ShadingModel::lambert);
  EXPECT_EQ(s.isovalue->value, 0.4);
  EXPECT_EQ(s.transferFunction->points().size(), 2u);
  for (const PointKey& key : pointKeys()) {
    std::string pointer = "/" + key.path;
    std::replace(pointer.begin(), pointer.end(), '.', '/');
    EXPECT_EQ(point.config.contains(json::json_pointer(pointer)), !key.applies || key.applies(s)) << key.path;
  }
}

/// Every kind of value that a point takes, none of them at its default.
json everything() {
  return json::parse(R"({
    "scene": "blob", "technique": {"name": "march_a", "parameters": {"step": 2, "bisections": 0, "filtering": "shader"}},
    "volume": {"generator": {"dims": [9, 8, 7], "spacing_mm": [0.1, 0.2, 0.3], "type": "float32"}},
    "visualisation_range": [-3, 500.5], "framing": {"up": [0, 0, 3], "front": [1, -1, 0]},
    "isovalue": {"raw": 12.5}, "transfer_function": {"points": [{"value": 0.1, "color": [0.1, 0.2, 0.3], "opacity": 0.7}]},
    "transfer_function_beyond": {"points": [{"value": 0.4, "color": [0.1, 0.2, 0.3], "opacity": 0.1}]},
    "shading": {"model": "phong", "surface_color": [0.3, 0.6, 0.9], "shadows": true},
    "light": {"headlight": false, "direction": [1, 2, 3], "spot": true, "distance": 2.5, "color": [0.5, 1.5, 1],
              "ambient": 0.25},
    "resolution": [320, 200], "stereo": {"enabled": true, "interpupillary_distance_mm": 64.5},
    "camera": {"fov_degrees": 41.1, "distance": 333.3},
    "timeline": {"path": "keys", "keys": [{"azimuth_degrees": 10}, {"elevation_degrees": -5, "distance_scale": 0.7, "cut": true}],
                 "isovalue_sweep": {"from": "skin", "to": {"raw": 3}},
                 "blend": {"to": {"points": [{"value": 0.2, "color": [1, 0, 0.5], "opacity": 0.25}]}, "cycles": 1.5},
                 "clipping_planes": [{"normal": [1, 1, 0.1], "offset": -2}], "play_time_steps": true},
    "pacing": {"mode": "timed", "warm_up_seconds": 0.5, "seconds": 3},
    "measure": {"replicates": 5, "breakdown_orbits": 0, "frames_in_flight": 2, "seed": 9007199254740992,
                "time_limit_seconds": 12.5, "interleave": 2},
    "pictures": {"count": 7, "reference": "none", "background": [1, 0.5, 0]}})");
}

TEST_F(PointTest, ItsConfigurationGivesItAgain) {
  for (const json& set : {json::object(), everything()}) {
    const json config = configOf(set);
    const PointSettings again = readPoint(config, "again", techniques(), m_folder / "scenes");
    EXPECT_EQ(writePoint(again), config);
    EXPECT_EQ(makePoint(config, {}, techniques(), m_folder / "scenes").config, config);
    // Through text, as between processes.
    EXPECT_EQ(configOf(json::parse(config.dump())).dump(), config.dump());
  }
}

TEST_F(PointTest, EverySettingReachesTheConfiguration) {
  const json defaults = configOf({});
  const json changed = configOf(everything());
  const json given = everything();
  for (const auto& [key, value] : given.items())
    EXPECT_TRUE(key == "scene" || changed[key] != defaults[key]) << key;
}

TEST_F(PointTest, EqualContentIsEqualTextHoweverItIsWritten) {
  const json nested =
      json::parse(R"({"pacing": {"frames": 10, "orbits": 2}, "camera": {"fov_degrees": 40}, "isovalue": "bone"})");
  const json dotted = json::parse(
      R"({"isovalue": {"normalized": 0.7}, "camera.fov_degrees": 40.0, "pacing.orbits": 2, "pacing.frames": 10})");
  EXPECT_EQ(configOf(nested).dump(), configOf(dotted).dump());
  EXPECT_EQ(configOf({{"light.ambient", 0.0}}).dump(), configOf({{"light.ambient", -0.0}}).dump());
}

TEST_F(PointTest, NamesAreResolved) {
  const json config = configOf({{"isovalue", "bone"}, {"transfer_function", "hard"}});
  EXPECT_EQ(config["isovalue"], json::parse(R"({"normalized": 0.7})"));
  EXPECT_EQ(config["transfer_function"]["points"][0]["opacity"], 0.9);
}

TEST_F(PointTest, ValuesOfOneKindReplaceAnother) {
  EXPECT_EQ(make({{"isovalue", {{"normalized", 0.5}}}}, {"isovalue={\"raw\": 3}"}).config["isovalue"],
            json::parse(R"({"raw": 3.0})"));
}

TEST_F(PointTest, GroupsDifferByAllButTheTechnique) {
  const Point a = make({{"technique.name", "march_a"}});
  EXPECT_EQ(a.group, make({{"technique.name", "march_b"}}).group);
  EXPECT_EQ(a.group, make({{"technique.parameters.step", 2}}).group);
  EXPECT_NE(a.group, make({{"isovalue", "bone"}}).group);
  EXPECT_NE(a.group, make({{"pacing.frames", 61}}).group);
}

TEST_F(PointTest, PicturesOfVolumesDoNotDependOnTheScenesIsovalue) {
  EXPECT_TRUE(make({{"technique.name", "integrate"}}).config["isovalue"].is_null());
  EXPECT_FALSE(make({{"technique.name", "integrate"}, {"isovalue", "bone"}}).config["isovalue"].is_null());
}

TEST_F(PointTest, UnknownNamesHaveTheNearest) {
  EXPECT_EQ(refusal({{"scene", "blub"}}),
            "command line: /scene: unknown scene \"blub\", did you mean \"blob\"? allowed: bare, blob or a path");
  EXPECT_EQ(refusal({{"technique.name", "march_c"}}), "command line: /technique.name: unknown technique \"march_c\", "
                                                      "did you mean \"march_a\"? allowed: integrate, march_a, march_b");
  EXPECT_EQ(refusal({{"isovalue", "bones"}}),
            "command line: /isovalue: unknown isovalue \"bones\" of scene \"blob\", did "
            "you mean \"bone\"? allowed: \"skin\", \"bone\"");
  EXPECT_EQ(refusal({{"transfer_function", "sofd"}}),
            "command line: /transfer_function: unknown transfer function \"sofd\" of scene \"blob\", did you mean "
            "\"soft\"? allowed: \"soft\", \"hard\"");
  EXPECT_EQ(refusal({{"scene", "no/such.json"}}), "command line: /scene: found no scene file \"no/such.json\"");
}

TEST_F(PointTest, ParametersAreCheckedInPlace) {
  EXPECT_THAT(
      refusal({{"technique.parameters.step", 9}}),
      HasSubstr("command line: /technique.parameters.step: technique \"march_a\": step: found 9, allowed: number"));
  EXPECT_THAT(
      refusal({{"technique.parameters", {{"stop", 1}}}}),
      HasSubstr(
          "/technique.parameters/stop: technique \"march_a\": unknown parameter \"stop\", did you mean \"step\""));
  EXPECT_THAT(refusal({{"technique.parameters.filtering", "software"}}),
              HasSubstr("allowed: \"hardware\", \"shader\""));
  EXPECT_THAT(refusal({{"technique.parameters.step", {1, 2}}}),
              HasSubstr("found [1,2], allowed: true or false, number"));
  EXPECT_THAT(refusal({{"technique.parameters.step", std::nan("")}}), HasSubstr("allowed: number"));
}

TEST_F(PointTest, TechniquesLimitShadingAndViews) {
  EXPECT_EQ(refusal({{"shading.model", "gooch"}}),
            "command line: /shading.model: found \"gooch\", allowed for technique "
            "\"march_a\": \"lambert\", \"phong\"");
  EXPECT_THAT(refusal({{"technique.name", "integrate"}, {"stereo.enabled", true}}),
              HasSubstr("/stereo.enabled: found 2 views, technique \"integrate\" draws at most 1"));
  EXPECT_NO_THROW(make({{"stereo.enabled", true}}));
  const json spot = {{"headlight", false}, {"direction", {0, 0, 1}}, {"spot", true}};
  EXPECT_THAT(refusal({{"technique.name", "integrate"}, {"light", spot}, {"shading.shadows", true}}),
              HasSubstr("/shading.shadows: found true, technique \"integrate\" draws no shadows"));
  EXPECT_THAT(refusal({{"shading.shadows", true}}), HasSubstr("only a spotlight casts shadows"));
  EXPECT_THAT(
      refusal({{"technique.name", "integrate"},
               {"timeline.clipping_planes", {{{"normal", {1, 0, 0}}, {"offset", 0}}}},
               {"transfer_function_beyond", "soft"}}),
      HasSubstr("/transfer_function_beyond: technique \"integrate\" does not draw what clipping planes cut off"));
  EXPECT_THAT(refusal({{"light", {{"headlight", false}, {"direction", {0, 0, 1}}, {"spot", true}, {"distance", 1}}}}),
              HasSubstr("/light/distance: found 1, allowed: number 1.1 to 100"));
}

TEST_F(PointTest, WithShadowsTheSlowReferenceHasToBeAskedFor) {
  const json lit = {{"light", {{"headlight", false}, {"direction", {0, 0, 1}}, {"spot", true}}},
                    {"shading.shadows", true}};
  json asked = lit;
  asked["pictures.reference"] = "cpu";
  EXPECT_EQ(configOf({})["pictures"]["reference"], "cpu");
  EXPECT_EQ(configOf(lit)["pictures"]["reference"], "none");
  EXPECT_EQ(configOf(asked)["pictures"]["reference"], "cpu");
}

TEST_F(PointTest, ScenesWithoutLabelsHaveNothingToHide) {
  EXPECT_THAT(refusal({{"hidden_segments", {1}}}), HasSubstr("/hidden_segments: scene \"blob\" has no labels"));
  EXPECT_THAT(refusal({{"hidden_segments", {128}}}), HasSubstr("found 128, allowed: integer 0 to 127"));
}

TEST_F(PointTest, ASceneHasToBeGiven) {
  EXPECT_THAT(refusal({{"scene", nullptr}}), HasSubstr("command line: key \"scene\" is missing"));
  EXPECT_NO_THROW(make({{"scene", "bare"}}));
  EXPECT_NO_THROW(make({{"scene", "bare"}, {"technique.name", "integrate"}}));
}

TEST_F(PointTest, ImpossibleValuesAreRefusedInPlace) {
  const std::pair<const char*, const char*> cases[] = {
      {R"({"resolution": [0, 5]})", "/resolution/0: found 0, allowed: integer 1 to 16384"},
      {R"({"resolution": [512]})", "/resolution: found [512], allowed: [width, height]"},
      {R"({"resolution": [512, 1e9]})", "/resolution/1: found 1000000000.0, allowed: integer 1 to 16384"},
      {R"({"camera.fov_degrees": 180})", "/camera.fov_degrees: found 180, allowed: number 1 to 170"},
      {R"({"camera": {"distance": "far"}})", "/camera/distance: found \"far\", allowed: \"fit\" or number"},
      {R"({"camera": {"distance": -1}})", "/camera/distance: found -1, allowed: number"},
      {R"({"pacing.frames": "ten"})", "/pacing.frames: found \"ten\", allowed: integer 1 to 100000"},
      {R"({"pacing.warm_up_frames": 2})", "/pacing.warm_up_frames: found 2, allowed: integer 3 to 10000"},
      {R"({"pacing.mode": "frame"})", "/pacing.mode: found \"frame\", did you mean \"frames\"?"},
      {R"({"visualisation_range": [3, 3]})", "/visualisation_range: found [3,3], allowed: [smallest, largest]"},
      {R"({"framing.up": [0, 0, 0]})", "/framing.up: found [0,0,0], allowed: a vector with a length"},
      {R"({"framing.front": [0, 1, 0.1]})", "/framing.front: up and front have to be orthogonal"},
      {R"({"timeline": {"path": "keys"}})", "timeline.keys: path \"keys\" needs at least one key pose"},
      {R"({"timeline": {"keys": [{"cutt": true}]}})", "/timeline/keys/0: unknown key \"cutt\", did you mean \"cut\"?"},
      {R"({"timeline": {"isovalue_sweep": {"from": "skin"}}})", "/timeline/isovalue_sweep: key \"to\" is missing"},
      {R"({"timeline": {"blend": {"cycles": 1}}})", "/timeline/blend: key \"to\" is missing"},
      {R"({"timeline": {"blend": {"to": "nobody"}}})", "unknown transfer function \"nobody\" of scene \"blob\""},
      {R"({"timeline.clipping_planes": [{}, {}, {}, {}, {}, {}, {}]})", "found 7 clipping planes, allowed: 6"},
      {R"({"light.direction": [0, 0, 0]})", "/light.direction: found [0,0,0]"},
      {R"({"volume.generator.dims": [0, 4, 4]})", "/volume.generator.dims/0: found 0, allowed: integer 1 to 4096"},
      {R"({"volume.generator.name": "other"})", "/volume.generator.name: found \"other\", allowed: \"marschner_lobb\""},
      {R"({"volume.generator.parameters": {"f_mm": 3}})", "/volume.generator.parameters: "},
      {R"({"volume": {"file": "x.nrrd"}})", "/volume/file: the volume of scene \"blob\" can only be changed"},
      {R"({"measure.seed": -1})", "/measure.seed: found -1, allowed: integer 0 to"},
  };
  for (const auto& [set, message] : cases)
    EXPECT_THAT(refusal(json::parse(set)), HasSubstr(message)) << set;
  EXPECT_THAT(refusal({{"scene", "bare"}, {"volume.generator.dims", {4, 4, 4}}}),
              HasSubstr("the volume of scene \"bare\" is a file, not generated"));
  EXPECT_THAT(refusal({{"camera.fov_degrees", std::nan("")}}), HasSubstr("allowed: number 1 to 170"));
}

TEST_F(PointTest, UnknownKeysHaveTheNearest) {
  EXPECT_THAT(
      refusal(json::parse(R"({"pacing": {"frame": 3}})")),
      HasSubstr("command line: /pacing: unknown key \"frame\", did you mean \"frames\"? allowed: frames, mode, "));
  EXPECT_THAT(
      refusal({{"pacing.frame", 3}}),
      HasSubstr("command line: unknown key \"pacing.frame\", did you mean \"frames\"? allowed in pacing: frames, "));
  EXPECT_THAT(refusal({{"resolution.width", 3}}), HasSubstr("allowed: \"resolution\" as a whole"));
  EXPECT_THAT(refusal({{"sceen", "blob"}}), HasSubstr("unknown key \"sceen\", did you mean \"scene\"?"));
  EXPECT_THAT(refusal({{"pacing", 3}}), HasSubstr("/pacing: found 3, allowed: object"));
  EXPECT_THAT(refusal({{"pacing", {{"frames", 3}}}, {"pacing.frames", 4}}),
              HasSubstr("\"pacing.frames\" is given twice"));
  EXPECT_THAT(refusal({{"technique.parameters.a.b", 3}}), HasSubstr("unknown key"));
  EXPECT_THAT(refusal({{"", 3}}), HasSubstr("unknown key \"\", allowed: "));
  EXPECT_THAT(refusal({{"", {{"resolution", {1, 1}}}}}), HasSubstr("unknown key \"\", allowed: "));
}

TEST_F(PointTest, AssignmentsComeOnTopAndNameThemselves) {
  const Point point =
      make({{"resolution", {64, 64}}}, {"resolution=[32, 16]", "technique.parameters.filtering=shader"});
  EXPECT_EQ(point.settings.width, 32);
  EXPECT_EQ(point.settings.parameters.text("filtering"), "shader");
  EXPECT_EQ(refusal({}, {"pacing.frames=ten"}),
            "--set pacing.frames=ten: /pacing.frames: found \"ten\", allowed: integer 1 to 100000");
  EXPECT_EQ(refusal({}, {"pacing.frames"}), "--set pacing.frames: allowed: key.path=value");
  EXPECT_THAT(refusal({}, {"resolution=[1,"}), HasSubstr("--set resolution=[1,: line 1, column 4: malformed JSON"));
}

TEST_F(PointTest, ScenesAreFoundByPath) {
  const std::string path = (m_folder / "scenes/blob.json").string();
  const Point point = make({{"scene", path}});
  EXPECT_EQ(point.config["scene"], path);
  EXPECT_EQ(point.settings.scene.title, "Blob");
}

TEST_F(PointTest, TheSceneShowsWhatThePointGenerates) {
  const Point point = make({{"volume.generator.dims", {5, 6, 7}}});
  EXPECT_EQ(std::get<GeneratorSource>(point.settings.scene.source).settings.dims, glm::ivec3(5, 6, 7));
  EXPECT_EQ(point.settings.scene.document["volume"]["generator"]["dims"], json({5, 6, 7}));
}

} // namespace
} // namespace volmark::test
