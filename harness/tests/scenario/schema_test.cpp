// The JSON Schemas, judged by python3-jsonschema: they accept what the reader accepts.
#include "tests/scenario/scenario_files.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

namespace volmark::test {
namespace {

using nlohmann::json;

constexpr const char* kPython = "/usr/bin/python3";
constexpr const char* kScript = R"(
import json, sys
try:
    import jsonschema
except ImportError:
    print("absent"); sys.exit()
schema, instances = json.load(open(sys.argv[1]))
jsonschema.Draft202012Validator.check_schema(schema)
validator = jsonschema.Draft202012Validator(schema)
for instance in instances:
    errors = [error.message for error in validator.iter_errors(instance)]
    print("valid" if not errors else "invalid: " + errors[0].replace("\n", " ")[:200])
print("end")
)";

class SchemaTest : public ScenarioTest {
protected:
  /// "valid" or "invalid: why" for each; empty if python3-jsonschema isn't there.
  std::vector<std::string> judge(const json& schema, const std::vector<json>& instances) const {
    const auto script = write("judge.py", kScript);
    const auto input = write("judge.json", json{schema, instances}.dump());
    FILE* pipe = ::popen((std::string(kPython) + " " + script.string() + " " + input.string()).c_str(), "r");
    std::vector<std::string> lines;
    for (char line[1000]; pipe && std::fgets(line, sizeof(line), pipe);)
      lines.push_back(std::string(line, std::strcspn(line, "\n")));
    if (pipe) ::pclose(pipe);
    if (lines.empty() || lines[0] == "absent") return {};
    EXPECT_EQ(lines.back(), "end") << "the schema itself is wrong";
    lines.pop_back();
    return lines;
  }
};

/// The techniques of configs/quick/quick.json as far as a scenario sees them.
const TechniqueCatalogue& quickTechniques() {
  static const TechniqueFactory iso = fakeTechnique(
      "iso_raymarch", Draws::isosurface, {ParameterDescriptor::number("step", 0.5, 0.01, 4, "voxel", "Step length.")});
  static const TechniqueFactory dvr = fakeTechnique(
      "dvr_raymarch", Draws::volume,
      {ParameterDescriptor::number("step", 0.5, 0.01, 4, "voxel", "Step length."),
       ParameterDescriptor::choice("transfer_function_kind", "post", {"post", "preintegrated"}, "When it is applied."),
       ParameterDescriptor::integer("preintegrated_size", 256, 16, 512, "", "Entries a side.")});
  static const TechniqueCatalogue catalogue = [] {
    TechniqueCatalogue result;
    result.add(iso, "raymarch");
    result.add(dvr, "raymarch");
    return result;
  }();
  return catalogue;
}

#define JUDGE_OR_SKIP(name, schema, instances)                                                                         \
  const std::vector<std::string> name = judge(schema, instances);                                                      \
  if (name.empty()) GTEST_SKIP() << "python3-jsonschema is not installed"

TEST_F(SchemaTest, AcceptsAndRefusesAsTheReaderDoes) {
  const std::string sets[] = {
      R"({})",
      R"({"pacing": {"frames": 10}, "camera.distance": "fit", "isovalue": "bone"})",
      R"({"pacing": null, "camera.fov_degrees": null})",
      R"({"isovalue": {"raw": 10}, "transfer_function": "soft", "visualisation_range": "data"})",
      R"({"transfer_function": {"points": [{"value": 0, "color": [1, 1, 1], "opacity": 0}]}})",
      R"({"volume.generator": {"dims": [4, 4, 4]}, "volume": {"generator": {"type": "int16"}}})",
      R"({"timeline": {"path": "keys", "keys": [{"azimuth_degrees": 3, "cut": true}]}})",
      R"({"timeline.isovalue_sweep": {"from": "skin", "to": {"normalized": 1}}})",
      R"({"timeline.clipping_planes": [{"normal": [1, 0, 0]}]})",
      R"({"technique": {"name": "march_a", "parameters": {"step": 2, "filtering": "shader"}}})",
      R"({"technique.name": "march_a", "technique.parameters.step": 1})",
      R"({"technique.name": "march_b", "technique.parameters": {"fast": false}})",
      // Refused by both.
      R"({"pacing": {"frame": 10}})",
      R"({"pacing.frame": 10})",
      R"({"pacing.frames": "ten"})",
      R"({"pacing": 3})",
      R"({"resolution": [512]})",
      R"({"resolution": [0, 512]})",
      R"({"isovalue": {"normalized": 2}})",
      R"({"isovalue": {"normalized": 0.1, "raw": 2}})",
      R"({"shading.model": "toon"})",
      R"({"camera": {"distance": "far"}})",
      R"({"camera.fov_degrees": 180})",
      R"({"measure.seed": 1.5})",
      R"({"timeline": {"keys": [{"azimut_degrees": 3}]}})",
      R"({"timeline.clipping_planes": [{"offset": 1}]})",
      R"({"volume": {"generator": {"dims": [4, 4]}}})",
      R"({"technique.name": "march_c"})",
      R"({"technique.name": "march_a", "technique.parameters.step": 9})",
      R"({"technique.name": "march_a", "technique.parameters.fast": true})",
      R"({"technique": {"name": "march_a", "parameters": {"stop": 1}}})",
      R"({"technique": {"name": "march_a"}, "technique.parameters": {"filtering": "software"}})",
      R"({"technique.parameters.step": [1]})",
  };
  std::vector<json> instances;
  std::vector<bool> accepted;
  for (const std::string& set : sets) {
    instances.push_back({{"volmark", 1}, {"name", "a"}, {"set", json::parse(set)}});
    json whole = instances.back();
    json base = {{"scene", "blob"}, {"technique.name", "march_a"}};
    if (whole["set"].contains("technique")) base.erase("technique.name");
    for (const auto& [key, value] : base.items())
      if (!whole["set"].contains(key)) whole["set"][key] = value;
    try {
      readFile(write("a.json", whole.dump()));
      accepted.push_back(true);
    } catch (const InputError&) {
      accepted.push_back(false);
    }
  }
  JUDGE_OR_SKIP(verdicts, scenarioSchema(techniques()), instances);
  ASSERT_EQ(verdicts.size(), instances.size());
  for (std::size_t i = 0; i < instances.size(); ++i)
    EXPECT_EQ(verdicts[i] == "valid", accepted[i]) << sets[i] << "\n" << verdicts[i];
  EXPECT_EQ(std::count(accepted.begin(), accepted.end(), true), 12);
}

TEST_F(SchemaTest, KnowsBlocksAxesAndProfiles) {
  const std::string good[] = {
      R"("blocks": [{"set": {"technique.name": "march_a"}, "axes": {"s": {"path": "technique.parameters.step", "values": [1, 2]}}}])",
      R"("blocks": [{"axes": {"c": {"values": [{"label": "x", "set": {"pacing": {"frames": 3}}}]}}}])",
      R"("limits": {"pixels": 10, "voxels": null}, "profiles": {"p": {"set": {"pacing": null}, "blocks": {"0": {"axes": null}}}})",
  };
  const std::string bad[] = {
      R"("block": [])",
      R"("blocks": [])",
      R"("blocks": [{"axis": {}}])",
      R"("blocks": [{"axes": {"s": {"values": [1]}}}])",
      R"("blocks": [{"axes": {"s": {"path": "measure.seed"}}}])",
      R"("blocks": [{"axes": {"c": {"values": [{"label": "x", "set": {"pacing": {"frame": 3}}}]}}}])",
      R"("blocks": [{"set": {"technique.name": "march_a"}, "axes": {"s": {"path": "technique.parameters.step", "values": [1, 9]}}}])",
      R"("limits": {"pixel": 10})",
      R"("profiles": {"p": {"sets": {}}})",
      R"("title": 3)",
  };
  std::vector<json> instances;
  for (const std::string& text : good)
    instances.push_back(json::parse(R"({"volmark": 1, "name": "a", )" + text + "}"));
  for (const std::string& text : bad)
    instances.push_back(json::parse(R"({"volmark": 1, "name": "a", )" + text + "}"));
  instances.push_back(json::parse(R"({"volmark": 2, "name": "a"})"));
  instances.push_back(json::parse(R"({"volmark": 1})"));
  JUDGE_OR_SKIP(verdicts, scenarioSchema(techniques()), instances);
  ASSERT_EQ(verdicts.size(), instances.size());
  for (std::size_t i = 0; i < instances.size(); ++i)
    EXPECT_EQ(verdicts[i] == "valid", i < std::size(good)) << instances[i] << verdicts[i];
}

TEST_F(SchemaTest, AcceptsTheScenesThatAreHere) {
  std::vector<json> instances;
  for (const auto& entry : std::filesystem::directory_iterator(VOLMARK_SOURCE_DIR "/scenes"))
    if (entry.path().extension() == ".json") instances.push_back(readJsonFile(entry.path()));
  const auto generated = [](const std::string& generator) {
    return json::parse(R"({"volmark_scene": 1, "title": "a", "volume": {"generator": )" + generator + "}}");
  };
  instances.push_back(generated(R"({"name": "gyroid", "dims": [4, 4, 4], "parameters": {"periods": 2.5}})"));
  const std::size_t good = instances.size();
  ASSERT_GT(good, 1u);
  instances.push_back(generated(R"({"name": "gyroids", "dims": [4, 4, 4]})"));
  instances.push_back(generated(R"({"name": "gyroid", "dims": [4, 4, 4], "parameters": {"period": 2}})"));
  instances.push_back(generated(R"({"name": "gyroid", "dims": [4, 4, 4], "parameters": {"periods": 0}})"));
  instances.push_back(generated(R"({"name": "blast_wave", "dims": [4, 4, 4], "parameters": {"time_steps": 2.5}})"));
  instances.push_back(json::parse(R"({"volmark_scene": 1, "title": "a", "volume": {"file": "a", "raw": {}}})"));
  instances.push_back(
      json::parse(R"({"volmark_scene": 1, "title": "a", "volume": {"file": "a"}, "isovalues": {"a": "b"}})"));
  instances.push_back(json::parse(R"({"volmark_scene": 1, "title": "a", "volume": {"file": "a"}, "framings": {}})"));
  instances.push_back(json::parse(R"({"title": "a", "volume": {"file": "a"}})"));
  for (const char* source :
       {R"({"package": "a"})", R"({"package_file": "/a"})", R"({"package": "a", "package_file": "a"})",
        R"({"raw": {"dims": [1, 1, 1], "type": "int8"}})", R"({"url": "a", "raw": {"dims": [1, 1, 1]}})"}) {
    instances.push_back(json::parse(R"({"volmark_scene": 1, "title": "a", "volume": {"file": "a"}})"));
    instances.back()["source"] = json::parse(source);
  }
  JUDGE_OR_SKIP(verdicts, sceneSchema(), instances);
  ASSERT_EQ(verdicts.size(), instances.size());
  for (std::size_t i = 0; i < instances.size(); ++i)
    EXPECT_EQ(verdicts[i] == "valid", i < good) << instances[i] << verdicts[i];
}

TEST_F(SchemaTest, TheQuickScenarioExpandsWithEveryProfile) {
  const std::filesystem::path source(VOLMARK_SOURCE_DIR);
  for (const std::string profile : {"", "paper", "desktop", "lavapipe", "smoke"}) {
    const Scenario scenario =
        readScenario({source / "configs/quick/quick.json", profile, {}, source / "scenes", source / "configs/profiles"},
                     quickTechniques());
    ASSERT_EQ(scenario.points.size(), 8u) << profile;
    const PointSettings& first = scenario.points[0].settings;
    EXPECT_EQ(first.width, profile == "smoke" ? 64 : 192);
    EXPECT_EQ(first.pacing.frames, profile == "smoke" ? 4 : 12);
    EXPECT_EQ(first.pacing.orbits, profile == "smoke" ? 1 : 3);
  }
}

} // namespace
} // namespace volmark::test
