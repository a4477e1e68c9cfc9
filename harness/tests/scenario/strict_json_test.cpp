// Reading JSON strictly: each kind of error, one line, with file and pointer.
#include "scenario/strict_json.h"
#include "volmark/error.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <limits>

namespace volmark {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

template <class Action> std::string errorOf(Action&& action) {
  try {
    action();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
    return error.what();
  }
  ADD_FAILURE() << "no InputError";
  return "";
}

std::string parseError(const std::string& text) {
  return errorOf([&] { parseOrderedJson(text, "a.json"); });
}

TEST(ParseJson, NamesLineAndColumnOfMalformedText) {
  EXPECT_THAT(parseError("{\"a\": 1,\n \"b\" 2}"), HasSubstr("a.json: line 2, column 6: malformed JSON: "));
  EXPECT_THAT(parseError("{\"a\": 1,\n}"), HasSubstr("a.json: line 2, column 1: "));
  EXPECT_THAT(parseError(""), HasSubstr("a.json: line 1, column 1: "));
  EXPECT_THAT(parseError("{\"a\": NaN}"), HasSubstr("a.json: line 1, column 7: "));
  EXPECT_THAT(parseError("{\"a\": 1} x"), HasSubstr("malformed JSON"));
  EXPECT_THAT(parseError("{\"a\": \"\xff\"}"), HasSubstr("malformed JSON"));
  EXPECT_THAT(parseError("{\"a\": 1e999}"), HasSubstr("malformed JSON"));
}

TEST(ParseJson, RefusesDuplicateKeysAnywhere) {
  EXPECT_EQ(parseError(R"({"a": 1, "a": 1})"), "a.json: key \"a\" stands twice");
  EXPECT_EQ(parseError(R"({"x": [0, {}, {"b": {"c/d": {"k": 1, "k": 2}}}]})"),
            "a.json: /x/2/b/c~1d: key \"k\" stands twice");
  EXPECT_NO_THROW(parseOrderedJson(R"({"a": {"k": 1}, "b": {"k": 1}, "c": [{"k": 1}, {"k": 1}]})", "a.json"));
}

TEST(ParseJson, LimitsDepthBothWays) {
  const auto nested = [](int depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  EXPECT_NO_THROW(parseOrderedJson(nested(64), "a.json"));
  EXPECT_EQ(parseError(nested(65)), "a.json: nested too deeply, allowed: 64 levels");
  EXPECT_THAT(parseError(std::string(1000000, '[')), HasSubstr("nested too deeply"));
  EXPECT_NO_THROW(parseOrderedJson("[" + std::string("[],[],") + "[]]", "a.json"));
}

std::string objectOf(int keys) {
  std::string text = "{";
  for (int i = 0; i < keys; ++i)
    text += fmt::format("{}\"{}\":0", i == 0 ? "" : ",", i);
  return text + "}";
}

TEST(ParseJson, LimitsKeysOfEachObject) {
  EXPECT_NO_THROW(parseOrderedJson("[" + objectOf(512) + "," + objectOf(512) + "]", "a.json"));
  EXPECT_EQ(parseError("[{},{\"a/b\":" + objectOf(513) + "}]"), "a.json: /1/a~1b: too many keys, allowed: 512");
}

TEST(ParseJson, KeepsTheOrderOfKeys) {
  const auto json = parseOrderedJson(R"({"z": 1, "a": 2, "m": 3})", "a.json");
  std::string order;
  for (const auto& [key, ignored] : json.items())
    order += key;
  EXPECT_EQ(order, "zam");
}

TEST(ParseJson, KeysCannotBreakTheLine) {
  EXPECT_EQ(parseError("{\"a\\nb\": 1, \"a\\nb\": 2}"), "a.json: key \"a\\u000ab\" stands twice");
}

TEST(ReadJsonFile, RefusesWhatIsNoFile) {
  EXPECT_EQ(errorOf([] { readJsonFile("/nowhere/a.json"); }), "/nowhere/a.json: no such file");
  EXPECT_THAT(errorOf([] { readJsonFile("/"); }), HasSubstr("no such file"));
  EXPECT_THAT(errorOf([] { readJsonFile("/dev/zero"); }), HasSubstr("no such file"));
}

TEST(ReadJsonFile, RefusesHugeFilesBeforeReadingThem) {
  const auto path = std::filesystem::temp_directory_path() / "volmark_huge.json";
  std::ofstream(path) << "1";
  std::filesystem::resize_file(path, std::uintmax_t(1) << 33);
  EXPECT_THAT(errorOf([&] { readJsonFile(path); }), HasSubstr("found 8589934592 bytes, allowed: 4194304"));
  std::filesystem::remove(path);
}

class Values : public ::testing::Test {
protected:
  std::string refusal(const nlohmann::json& json, const std::function<void(const JsonValue&)>& read) {
    return errorOf([&] { read(JsonValue(json, "a.json", "/x")); });
  }
};

TEST_F(Values, SayFoundAndAllowed) {
  const auto integer = [](const JsonValue& value) { value.integer(1, 100000); };
  EXPECT_EQ(refusal("ten", integer), "a.json: /x: found \"ten\", allowed: integer 1 to 100000");
  EXPECT_EQ(refusal(0, integer), "a.json: /x: found 0, allowed: integer 1 to 100000");
  EXPECT_EQ(refusal(1.5, integer), "a.json: /x: found 1.5, allowed: integer 1 to 100000");
  EXPECT_EQ(refusal(std::numeric_limits<std::uint64_t>::max(), integer),
            "a.json: /x: found 18446744073709551615, allowed: integer 1 to 100000");
  const auto number = [](const JsonValue& value) { value.number(0, 1); };
  EXPECT_EQ(refusal(1.5, number), "a.json: /x: found 1.5, allowed: number 0 to 1");
  EXPECT_EQ(refusal(true, number), "a.json: /x: found true, allowed: number 0 to 1");
  EXPECT_EQ(refusal(nlohmann::json::array(), [](const JsonValue& value) { value.boolean(); }),
            "a.json: /x: found [], allowed: true or false");
  EXPECT_EQ(refusal("", [](const JsonValue& value) { value.text(); }),
            "a.json: /x: found \"\", allowed: text that is not empty");
  EXPECT_THAT(refusal(nlohmann::json::parse("[1, 2]"), [](const JsonValue& value) { value.numbers(3, 0, 1); }),
              HasSubstr("found [1,2], allowed: array of 3 numbers"));
  EXPECT_THAT(refusal(nlohmann::json::parse("[0, 2, 0]"), [](const JsonValue& value) { value.numbers(3, 0, 1); }),
              HasSubstr("a.json: /x/1: found 2, allowed: number 0 to 1"));
}

TEST_F(Values, NotANumberIsNoNumber) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    EXPECT_THAT(refusal(bad, [](const JsonValue& value) { value.number(-1e300, 1e300); }),
                HasSubstr("allowed: number"));
}

TEST_F(Values, BoundsAreInclusive) {
  const nlohmann::json low = 1, high = 3;
  EXPECT_EQ(JsonValue(low, "a.json").integer(1, 3), 1);
  EXPECT_EQ(JsonValue(high, "a.json").integer(1, 3), 3);
  EXPECT_EQ(JsonValue(high, "a.json").number(1, 3), 3.0);
}

TEST_F(Values, ChoicesNameTheNearest) {
  const auto choice = [](const JsonValue& value) { value.choice({"none", "gooch"}); };
  EXPECT_EQ(refusal("goosh", choice),
            "a.json: /x: found \"goosh\", did you mean \"gooch\"? allowed: \"none\", \"gooch\"");
  EXPECT_EQ(refusal("xxxxxxxxx", choice), "a.json: /x: found \"xxxxxxxxx\", allowed: \"none\", \"gooch\"");
}

TEST_F(Values, LongFindingsAreCut) {
  const std::string text = refusal(std::string(10000, 'y'), [](const JsonValue& value) { value.boolean(); });
  EXPECT_LT(text.size(), 200u);
}

TEST(JsonObject, RefusesUnknownKeysWithTheNearest) {
  const nlohmann::json json = {{"frame", 1}, {"mode", "frames"}};
  JsonObject object(JsonValue(json, "a.json", "/pacing"));
  EXPECT_FALSE(object.find("frames"));
  EXPECT_TRUE(object.find("mode"));
  EXPECT_EQ(errorOf([&] { object.refuseOthers(); }),
            "a.json: /pacing: unknown key \"frame\", did you mean \"frames\"? allowed: frames, mode");
  EXPECT_EQ(errorOf([&] { object.at("orbits"); }), "a.json: /pacing: key \"orbits\" is missing");
}

TEST(JsonObject, OnlyObjectsWillDo) {
  const nlohmann::json json = 3;
  EXPECT_EQ(errorOf([&] { JsonObject(JsonValue(json, "a.json")); }), "a.json: found 3, allowed: object");
}

} // namespace
} // namespace volmark
