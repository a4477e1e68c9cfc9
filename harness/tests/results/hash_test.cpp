#include "results/hash.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

namespace volmark {
namespace {

using Json = nlohmann::json;

const Json kConfig = Json::parse(R"({"scene": "sphere", "technique": {"name": "a", "parameters": {"step": 0.5, "n": 3}},
  "isovalue": {"normalized": 0.2}, "resolution": [64, 32], "measure": {"replicates": 1, "seed": 7}, "empty": null})");

TEST(PointHash, isThirtyTwoHexDigits) {
  EXPECT_THAT(pointHash(kConfig, "v"), testing::MatchesRegex("[0-9a-f]{32}"));
  EXPECT_THAT(runHash("p", "b", "d", 0), testing::MatchesRegex("[0-9a-f]{32}"));
}

// XXH3-128 of nothing, as published.
TEST(Digest, agreesWithTheSpecification) {
  EXPECT_EQ(digestOf(""), "99aa06d3014798d86001c324468d497f");
}

TEST(PointHash, orderOfKeysDoesNotMatter) {
  const std::string expected = pointHash(kConfig, "v");
  std::vector<std::string> keys;
  for (const auto& member : kConfig.items())
    keys.push_back(member.key());
  std::mt19937 engine(1);
  for (int i = 0; i < 20; ++i) {
    std::shuffle(keys.begin(), keys.end(), engine);
    std::string members;
    for (const std::string& key : keys) {
      if (!members.empty()) members += ',';
      members += fmt::format("{}:{}", Json(key).dump(), kConfig[key].dump());
    }
    EXPECT_EQ(pointHash(Json::parse(fmt::format("{{{}}}", members)), "v"), expected);
  }
}

TEST(PointHash, measureDoesNotMatter) {
  Json other = kConfig;
  other["measure"] = {{"replicates", 9}};
  EXPECT_EQ(pointHash(other, "v"), pointHash(kConfig, "v"));
  other.erase("measure");
  EXPECT_EQ(pointHash(other, "v"), pointHash(kConfig, "v"));
}

TEST(PointHash, spellingOfNumbersDoesNotMatter) {
  const auto hashOf = [](const char* text) { return pointHash(Json::parse(text), "v"); };
  EXPECT_EQ(hashOf(R"({"a": 1})"), hashOf(R"({"a": 1.0})"));
  EXPECT_EQ(hashOf(R"({"a": [2e3]})"), hashOf(R"({"a": [2000]})"));
  EXPECT_EQ(hashOf(R"({"a": -0.0})"), hashOf(R"({"a": 0})"));
  EXPECT_EQ(hashOf(R"({"a": 0.1})"), hashOf(R"({"a": 0.10000000000000001})"));
  EXPECT_EQ(pointHash({{"a", 5u}}, "v"), pointHash({{"a", 5}}, "v"));
}

// Whatever else changes, the hash changes.
TEST(PointHash, everyOtherValueMatters) {
  std::set<std::string> hashes{pointHash(kConfig, "v"), pointHash(kConfig, "w")};
  std::size_t expected = 2;
  const Json flat = kConfig.flatten();
  for (const auto& member : flat.items()) {
    if (member.key().rfind("/measure", 0) == 0) continue;
    Json changed = kConfig;
    changed[Json::json_pointer(member.key())] = "something else";
    hashes.insert(pointHash(changed, "v"));
    ++expected;
  }
  EXPECT_EQ(hashes.size(), expected);
  EXPECT_NE(pointHash({{"a", 0.1}}, "v"), pointHash({{"a", std::nextafter(0.1, 1)}}, "v"));
  EXPECT_NE(pointHash({{"a", "1"}}, "v"), pointHash({{"a", 1}}, "v"));
  EXPECT_NE(pointHash({{"a", {1, 2}}}, "v"), pointHash({{"a", {2, 1}}}, "v"));
}

TEST(RunHash, everyPartMatters) {
  const std::set<std::string> hashes{runHash("p", "b", "d", 0), runHash("q", "b", "d", 0), runHash("p", "c", "d", 0),
                                     runHash("p", "b", "e", 0), runHash("p", "b", "d", 1), runHash("pb", "", "d", 0),
                                     runHash("p", "bd", "", 0)};
  EXPECT_EQ(hashes.size(), 7u);
}

} // namespace
} // namespace volmark
