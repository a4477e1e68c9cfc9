// Parts of a grid: lists of points, exclusions, samples.
#include "scenario/point_keys.h"
#include "scenario/point_list.h"
#include "tests/scenario/scenario_files.h"

#include <set>

namespace volmark::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class SelectionTest : public ScenarioTest {
protected:
  /// A block of 3 x 2 combinations with more keys.
  static std::string grid(const std::string& more) {
    return std::string(kBlob) + R"(, "blocks": [{"axes": {
      "step": {"path": "technique.parameters.step", "values": [0.5, 1, 2]},
      "size": {"values": [{"label": "small", "set": {"resolution": [16, 16]}},
                          {"label": "large", "set": {"resolution": [64, 64]}}]}})" +
           more + "}]";
  }
  static std::set<std::string> labelsOf(const Scenario& scenario) {
    std::set<std::string> labels;
    for (const Point& point : scenario.points)
      labels.insert(point.labels[1].value + " " + point.labels[2].value);
    return labels;
  }
};

TEST_F(SelectionTest, ExclusionsLeaveOutWhatMatchesOnEveryAxis) {
  using Labels = std::set<std::string>;
  EXPECT_EQ(labelsOf(read(grid(""))).size(), 6u);
  EXPECT_EQ(labelsOf(read(grid(R"(, "exclude": [{"step": 0.5}])"))),
            (Labels{"1 small", "1 large", "2 small", "2 large"}));
  EXPECT_EQ(labelsOf(read(grid(R"(, "exclude": [{"step": [0.5, 2], "size": "large"}, {"step": 1, "size": "small"}])"))),
            (Labels{"0.5 small", "1 large", "2 small"}));
  const Scenario left = read(grid(R"(, "exclude": [{"step": [0.5, 2], "size": "large"}])"));
  for (std::size_t i = 0; i < left.points.size(); ++i)
    EXPECT_EQ(left.points[i].index, static_cast<int>(i));
  // An axis that was shortened from outside still works with the file's exclusions.
  EXPECT_EQ(read(grid(R"(, "exclude": [{"step": 0.5}])"), "", {"technique.parameters.step=2"}).points.size(), 2u);
}

TEST_F(SelectionTest, WrongExclusionsAreOneLine) {
  EXPECT_THAT(errorOf(grid(R"(, "exclude": [{"steps": 0.5}])")),
              HasSubstr("no axis \"steps\" in this block, did you mean \"step\"?"));
  EXPECT_THAT(errorOf(grid(R"(, "exclude": [{}])")), HasSubstr("a.json: /blocks/0/exclude/0: "));
  EXPECT_THAT(errorOf(grid(R"(, "exclude": [{"step": []}])")), HasSubstr("/blocks/0/exclude/0/step: "));
  EXPECT_THAT(errorOf(grid(R"(, "exclude": 3)")), HasSubstr("/blocks/0/exclude: "));
  EXPECT_THAT(errorOf(grid(R"(, "exclude": [{"step": [0.5, 1, 2]}])")), HasSubstr("no point is left"));
}

TEST_F(SelectionTest, SamplesAreSubsetsThatSeedsDecide) {
  const auto sampled = [&](const std::string& sample) {
    return labelsOf(read(R"("sample": )" + sample + ", " + grid("")));
  };
  const auto all = labelsOf(read(grid("")));
  std::set<std::set<std::string>> different;
  for (int seed = 0; seed < 20; ++seed) {
    const auto chosen = sampled(R"({"count": 3, "seed": )" + std::to_string(seed) + "}");
    EXPECT_EQ(chosen.size(), 3u);
    EXPECT_TRUE(std::includes(all.begin(), all.end(), chosen.begin(), chosen.end()));
    EXPECT_EQ(chosen, sampled(R"({"count": 3, "seed": )" + std::to_string(seed) + "}"));
    different.insert(chosen);
  }
  EXPECT_GT(different.size(), 5u);
  EXPECT_EQ(sampled(R"({"count": 6})"), all);
  EXPECT_EQ(sampled(R"({"count": 100})"), all);
  EXPECT_EQ(read(grid(""), "", {"sample.count=2"}).points.size(), 2u);
}

TEST_F(SelectionTest, ASampleOfAGrownGridKeepsWhatItHad) {
  // The ranks of points don't depend on which others there are: of the larger grid's sample, those that the smaller
  // grid has are a part of the smaller one's sample.
  const auto sampled = [&](const std::string& values) {
    std::set<std::string> labels;
    const Scenario scenario =
        read(std::string(R"("sample": {"count": 8, "seed": 5}, )") + kBlob + R"(, "blocks": [{"axes": {
      "seed": {"path": "measure.seed", "values": [)" +
             values + "]}}}]");
    for (const Point& point : scenario.points)
      labels.insert(point.labels[1].value);
    return labels;
  };
  std::string small, large;
  for (int i = 0; i < 40; ++i)
    (i < 20 ? small : large) += (i % 20 ? "," : "") + std::to_string(i);
  const auto few = sampled(small);
  int kept = 0;
  for (const std::string& label : sampled(small + "," + large)) {
    if (std::stoi(label) >= 20) continue;
    EXPECT_EQ(few.count(label), 1u) << label;
    ++kept;
  }
  EXPECT_GT(kept, 0);
}

TEST_F(SelectionTest, WrongSamplesAreOneLine) {
  for (const char* sample : {"{}", R"({"count": 0})", R"({"count": 1.5})", R"({"count": 3, "seeds": 1})", "3"})
    EXPECT_THAT(errorOf(R"("sample": )" + std::string(sample) + ", " + grid("")), HasSubstr("/sample")) << sample;
}

TEST(PointList, TakesNumbersAndRanges) {
  EXPECT_THAT(parsePointList("3", 4, "--points"), ElementsAre(3));
  EXPECT_THAT(parsePointList("5,0-2,1", 6, "--points"), ElementsAre(0, 1, 2, 5));
  for (const char* text : {"", "4", "-1", "1-", "3-2", "a", "1,,2", "1 ,2", "0-99999999999", "1-2-3"}) {
    try {
      parsePointList(text, 4, "--points");
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("--points: found ")) << text;
      EXPECT_THAT(error.what(), HasSubstr("0 to 3"));
    }
  }
}

// What a worker of another build reads: it may not know the keys that stand at their defaults here.
TEST_F(SelectionTest, ConfigurationsWithoutDefaultsReadToTheSame) {
  const Scenario scenario = read(grid(""));
  for (const Point& point : scenario.points) {
    const nlohmann::json lean = withoutDefaults(point.config);
    EXPECT_FALSE(lean.contains("measure")) << lean;
    EXPECT_FALSE(lean.contains("pacing")) << lean;
    EXPECT_FALSE(lean.contains("stereo")) << lean;
    EXPECT_EQ(writePoint(readPoint(lean, "lean", techniques(), m_folder / "scenes")), point.config);
  }
}

} // namespace
} // namespace volmark::test
