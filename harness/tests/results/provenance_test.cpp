#include "fixture.h"

#include <gmock/gmock.h>

namespace volmark::results_test {
namespace {

using testing::MatchesRegex;

TEST(Provenance, saysOnWhatARunWasMade) {
  const nlohmann::json facts = provenance(nullptr);
  EXPECT_THAT(facts["program"]["version"].get<std::string>(), MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
  EXPECT_THAT(facts["program"]["commit"].get<std::string>(), MatchesRegex("[0-9a-f]{40}|unknown"));
  EXPECT_EQ(facts["program"]["commit"] == "unknown", facts["program"]["dirty"].is_null());
  EXPECT_THAT(facts["program"]["digest"].get<std::string>(), MatchesRegex("[0-9a-f]{32}"));
  EXPECT_FALSE(facts["build"]["compiler"].get<std::string>().empty());
  EXPECT_TRUE(facts["build"]["flags"].is_string());
  for (const char* library : {"fmt", "glm", "glslang", "nlohmann_json", "openexr", "xxhash", "zlib"})
    EXPECT_THAT(facts["libraries"][library].get<std::string>(), MatchesRegex("[0-9]+\\.[0-9].*")) << library;
  EXPECT_THAT(facts["started"].get<std::string>(),
              MatchesRegex("[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}\\.[0-9]{3}Z"));
  EXPECT_EQ(facts["device"], nlohmann::json({{"identity", "host"}}));
}

TEST(Provenance, countsTheMachine) {
  const nlohmann::json host = provenance(nullptr)["host"];
  EXPECT_EQ(host["name"], hostName());
  EXPECT_GE(host["logical_cores"], 1);
  EXPECT_GE(host["logical_cores"], host["usable_cores"]);
  EXPECT_EQ(host["load_average"].size(), 3u);
  EXPECT_GT(host["memory_total_bytes"], 1 << 20);
  EXPECT_LE(host["memory_available_bytes"], host["memory_total_bytes"]);
  EXPECT_TRUE(host["governor"].is_null() || host["governor"].is_string());
}

TEST(Provenance, keepsTheVariablesThatDriversRead) {
  setenv("LP_NUM_THREADS", "2", 1);
  setenv("VOLMARK_SOMETHING", "a=b", 1);
  setenv("HELP_ME", "no", 1);
  const nlohmann::json variables = provenance(nullptr)["environment"];
  EXPECT_EQ(variables["LP_NUM_THREADS"], "2");
  EXPECT_EQ(variables["VOLMARK_SOMETHING"], "a=b");
  for (const auto& variable : variables.items())
    EXPECT_THAT(variable.key(), MatchesRegex("(LP|MESA|VK|VOLMARK)_.*"));
}

TEST(Provenance, hasTheFactsOfADevice) {
  gpu::DeviceFacts facts;
  facts.name = "some GPU";
  facts.driverName = "driver";
  facts.driverInfo = "1.2";
  facts.maximumWorkgroupCount[2] = 7;
  facts.meshShader = true;
  const nlohmann::json device = provenance(&facts)["device"];
  EXPECT_EQ(device["identity"], "some GPU / driver / 1.2");
  EXPECT_EQ(device["maximum_workgroup_count"], nlohmann::json({0, 0, 7}));
  EXPECT_EQ(device["mesh_shader"], true);
}

TEST(DeviceIdentity, tellsDriversApart) {
  gpu::DeviceFacts facts;
  facts.name = "GPU";
  const std::string before = deviceIdentity(&facts);
  facts.driverInfo = "2";
  EXPECT_NE(deviceIdentity(&facts), before);
  EXPECT_EQ(deviceIdentity(nullptr), "host");
}

TEST(BuildDigest, dependsOnTheModule) {
  EXPECT_THAT(buildDigest("module"), MatchesRegex("[0-9a-f]{32}"));
  EXPECT_EQ(buildDigest("module"), buildDigest("module"));
  EXPECT_NE(buildDigest("module"), buildDigest("other module"));
}

} // namespace
} // namespace volmark::results_test
