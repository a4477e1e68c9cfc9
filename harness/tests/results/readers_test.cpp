// The written files as other programs read them: pandas, Google Benchmark's compare.py.
#include "fixture.h"
#include "results/csv.h"

#include <gmock/gmock.h>

#include <limits>
#include <random>

namespace volmark::results_test {
namespace {

using testing::HasSubstr;

constexpr const char* kComparePy = "/usr/share/benchmark/compare.py";

/// All points of the scenario, two replicates each; the last point doesn't complete.
Experiment filledExperiment(const fs::path& results, double scale, const std::string& name = "quick") {
  const Scenario scenario = makeScenario(name);
  const Experiment experiment(results, scenario);
  const TechniqueFactory factories[] = {fakeFactory("fake_a"), fakeFactory("fake_b")};
  for (std::size_t i = 0; i < scenario.points.size(); ++i) {
    for (int replicate = 0; replicate < 2; ++replicate) {
      RunRecord record = makeRecord(4, 3, scale * static_cast<double>(i + 1));
      const RunIdentity identity = identityOf(scenario.points[i], replicate);
      const fs::path stage = experiment.stage(identity);
      if (i == 0) addPicture(record, stage, {.mse = 1e-4, .psnrDb = 40.5, .ssim = 0.98, .flip = 0.03});
      if (i <= 1) addPicture(record, stage, {.identical = true, .ssim = 1.0});
      if (i == 3) {
        record.status = RunStatus::unsupported;
        record.reason = "needs a \"bigger\", better GPU";
      }
      experiment.commit(identity, scenario.points[i], entryOf(factories[i / 2]), record);
    }
  }
  experiment.writeIndex();
  return experiment;
}

// Every number of a random table comes back bit for bit, every text letter for letter.
TEST(Csv, roundTripsThroughPandasAndCsv) {
  if (!pythonHas("pandas")) GTEST_SKIP() << "no pandas";
  const TemporaryFolder folder;
  std::mt19937_64 engine(9);
  CsvText csv("frames", {"a", "b, \"quoted\"", "text"});
  std::ofstream expected(folder.path() / "expected.txt");
  const std::vector<std::string> texts{"plain", "with, comma", "\"quoted\"", "# not a comment", "[0.5,1]", "zwölf"};
  for (int row = 0; row < 500; ++row) {
    double value = std::ldexp(static_cast<double>(engine()), static_cast<int>(engine() % 160) - 120);
    if (row % 50 == 0) value = std::nan("");
    if (row == 7) value = std::numeric_limits<double>::infinity();
    if (row == 8) value = std::numeric_limits<double>::denorm_min();
    csv.number(value).integer(static_cast<std::int64_t>(row)).text(texts[engine() % texts.size()]).endRow();
    expected << fmt::format("{:a}", value) << '\n';
  }
  expected.close();
  std::ofstream(folder.path() / "frames.csv") << csv.str();
  const auto [status, output] = runPython(
      folder.path(), R"(
import csv, math, sys
import pandas as pd
path, expected = sys.argv[1:]
assert open(path).readline() == '# volmark.frames 1\n'
wanted = [float.fromhex(line) for line in open(expected)]
table = pd.read_csv(path, skiprows=1, float_precision='round_trip')
rows = list(csv.DictReader(open(path, newline='').readlines()[1:]))
assert list(table.columns) == ['a', 'b, "quoted"', 'text'] == list(rows[0])
assert len(table) == len(rows) == len(wanted)
texts = {'plain', 'with, comma', '"quoted"', '# not a comment', '[0.5,1]', 'zwölf'}
for i, (value, row) in enumerate(zip(wanted, rows)):
    if math.isnan(value):
        assert row['a'] == '' and math.isnan(table['a'][i])
    else:
        assert float(row['a']) == value == table['a'][i], (i, row['a'], value)
    assert row['text'] == table['text'][i] and row['text'] in texts
    assert int(row['b, "quoted"']) == i
)",
      fmt::format("'{}' '{}'", (folder.path() / "frames.csv").string(), (folder.path() / "expected.txt").string()));
  EXPECT_EQ(status, 0) << output;
}

TEST(Csv, filesOfARunAreReadByPandas) {
  if (!pythonHas("pandas")) GTEST_SKIP() << "no pandas";
  const TemporaryFolder folder;
  const Experiment experiment = filledExperiment(folder.path(), 1);
  const fs::path run = experiment.runFolder(identityOf(makePointOf("fake_a", 0.5)));
  const auto [status, output] = runPython(folder.path(), R"(
import json, sys
import numpy as np
import pandas as pd
run = sys.argv[1]
frames = pd.read_csv(run + '/frames.csv', skiprows=1, float_precision='round_trip')
assert list(frames.columns) == ['orbit_kind', 'orbit', 'frame', 'phase', 'host_ms', 'interval_ms', 'cpu_ms', 'update_ms',
                                'draw_ms', 'frame_ms', 'gpu_ms', 'disturbed', 'pass.march', 'pass.never']
headline = frames[frames.orbit_kind == 'headline']
assert len(headline) == 12 and headline['pass.march'].isna().all() and frames.gpu_ms.isna().all()
breakdown = frames[frames.orbit_kind == 'breakdown']
assert np.allclose(breakdown['pass.march'], breakdown.draw_ms)
document = json.load(open(run + '/run.json'))
assert abs(headline.frame_ms.mean() - document['statistics']['frame']['mean_ms']) < 1e-12
assert abs(np.percentile(headline.frame_ms, 99) - document['statistics']['frame']['p99_ms']) < 1e-12
assert list(document)[:4] == ['format', 'version', 'run', 'point'], 'order of the README'
assert list(document['labels']) == ['technique', 'step'], 'order of the axes'
counters = pd.read_csv(run + '/counters.csv', skiprows=1)
assert list(counters.columns) == ['frame', 'phase', 'samples']
assert counters.samples[1] == 18446744073709551615
pictures = pd.read_csv(run + '/pictures.csv', skiprows=1)
assert list(pictures.columns) == list(document['pictures'][0])
assert list(pictures.identical) == [False, True] and pictures.psnr_db[0] == 40.5 and np.isnan(pictures.psnr_db[1])
)",
                                          fmt::format("'{}'", run.string()));
  EXPECT_EQ(status, 0) << output;
}

TEST(Index, isRebuiltFromTheRuns) {
  const TemporaryFolder folder;
  const Experiment experiment = filledExperiment(folder.path(), 1);
  for (const char* name : {"index.csv", "google_benchmark.json"}) {
    const fs::path file = experiment.folder() / name;
    const std::string before = readText(file);
    EXPECT_FALSE(before.empty());
    fs::remove(file);
    experiment.writeIndex();
    EXPECT_EQ(readText(file), before);
  }
}

// Runs that are being written, or were left half-made, don't count.
TEST(Index, leavesOutUnfinishedRuns) {
  const TemporaryFolder folder;
  const Experiment experiment = filledExperiment(folder.path(), 1);
  const std::string before = readText(experiment.folder() / "index.csv");
  const Point point = makePointOf("fake_a", 8);
  const fs::path stage = experiment.stage(identityOf(point));
  fs::copy_file(experiment.runFolder(identityOf(makePointOf("fake_a", 0.5))) / "run.json", stage / "run.json");
  const auto claim = experiment.claim(identityOf(makePointOf("fake_a", 9)));
  fs::create_directories(experiment.folder() / "runs" / "zz" / "empty");
  experiment.writeIndex();
  EXPECT_EQ(readText(experiment.folder() / "index.csv"), before);
}

TEST(Index, isReadByPandas) {
  if (!pythonHas("pandas")) GTEST_SKIP() << "no pandas";
  const TemporaryFolder folder;
  const Experiment experiment = filledExperiment(folder.path(), 1);
  const auto [status, output] = runPython(folder.path(), R"(
import sys
import numpy as np
import pandas as pd
assert open(sys.argv[1]).readline() == '# volmark.index 1\n'
table = pd.read_csv(sys.argv[1], skiprows=1)
assert list(table.columns) == ['run', 'point', 'replicate', 'status', 'reason', 'label.technique', 'label.step', 'mean_ms',
    'median_ms', 'p99_ms', 'low1_avg_ms', 'fps', 'host_median_ms', 'cpu_median_ms', 'psnr_db', 'ssim', 'flip', 'flip_hdr', 'generation_ms',
    'memory_bytes', 'device', 'commit', 'started'], list(table.columns)
assert list(table['label.technique']) == ['fake_a'] * 4 + ['fake_b'] * 4
assert list(table['label.step']) == [0.5, 0.5, 1, 1] * 2 and list(table.replicate) == [0, 1] * 4
assert list(table.psnr_db[:4]) == [40.5, 40.5, np.inf, np.inf] and table.psnr_db[4:].isna().all()
assert list(table.ssim[:4]) == [0.98, 0.98, 1, 1] and list(table.flip[:4]) == [0.03, 0.03, 0, 0]
assert table.flip[4:].isna().all() and table.flip_hdr.isna().all()
assert list(table.status) == ['completed'] * 6 + ['unsupported'] * 2
assert table.reason[7] == 'needs a "bigger", better GPU' and table.mean_ms[6:].isna().all()
assert np.allclose(table.fps[:6] * table.mean_ms[:6], 1000) and (table.generation_ms[:6] == 13.75).all()
)",
                                          fmt::format("'{}'", (experiment.folder() / "index.csv").string()));
  EXPECT_EQ(status, 0) << output;
}

TEST(Index, keepsLabelsOfAxesThatWereRenamed) {
  const TemporaryFolder folder;
  filledExperiment(folder.path(), 1);
  Scenario renamed = makeScenario();
  renamed.axes = {"technique", "spacing"};
  const Experiment experiment(folder.path(), renamed);
  experiment.writeIndex();
  EXPECT_THAT(readText(experiment.folder() / "index.csv"), HasSubstr("label.technique,label.spacing,label.step,"));
}

TEST(GoogleBenchmark, hasARepetitionPerOrbit) {
  const TemporaryFolder folder;
  const Experiment experiment = filledExperiment(folder.path(), 1);
  const auto document = readJson(experiment.folder() / "google_benchmark.json");
  ASSERT_TRUE(document);
  // 3 completed points with 2 replicates of 3 orbits and 4 aggregates.
  const auto& benchmarks = document->at("benchmarks");
  ASSERT_EQ(benchmarks.size(), 3u * (6 + 4));
  double sum = 0;
  for (int i = 0; i < 6; ++i) {
    const auto& entry = benchmarks[static_cast<std::size_t>(i)];
    EXPECT_EQ(entry["name"], "quick/technique:fake_a/step:0.5");
    EXPECT_EQ(entry["run_type"], "iteration");
    EXPECT_EQ(entry["repetitions"], 6);
    EXPECT_EQ(entry["repetition_index"], i);
    EXPECT_EQ(entry["iterations"], 4);
    EXPECT_EQ(entry["time_unit"], "ms");
    EXPECT_NEAR(entry["cpu_time"].get<double>() / entry["real_time"].get<double>(), 1.9, 1e-12);
    sum += entry["real_time"].get<double>();
  }
  EXPECT_EQ(benchmarks[6]["name"], "quick/technique:fake_a/step:0.5_mean");
  EXPECT_NEAR(benchmarks[6]["real_time"].get<double>(), sum / 6, 1e-12);
  EXPECT_EQ(benchmarks[9]["aggregate_name"], "cv");
  EXPECT_GT(document->at("context")["num_cpus"], 0);
}

// Only the build that was used last: older runs under the same name would be taken for repetitions.
TEST(GoogleBenchmark, takesTheLatestBuild) {
  const TemporaryFolder folder;
  const Scenario scenario = makeScenario();
  const Experiment experiment(folder.path(), scenario);
  const TechniqueFactory factory = fakeFactory("fake_a");
  for (const auto& [build, started, scale] :
       {std::tuple{"b", "2025-01-02", 2.0}, {"a", "2025-01-01", 1.0}, {"c", "2024-12-31", 3.0}}) {
    RunRecord record = makeRecord(4, 3, scale);
    record.provenance["program"]["digest"] = build;
    record.provenance["started"] = started;
    experiment.commit(identityOf(scenario.points[0], 0, build), scenario.points[0], entryOf(factory), record);
  }
  experiment.writeIndex();
  const auto document = readJson(experiment.folder() / "google_benchmark.json");
  ASSERT_EQ(document->at("benchmarks").size(), 3u + 4);
  EXPECT_NEAR(document->at("benchmarks")[3]["real_time"].get<double>(), 10, 1);
}

TEST(GoogleBenchmark, isAcceptedByComparePy) {
  if (!fs::exists(kComparePy) || !pythonHas("scipy")) GTEST_SKIP() << "no " << kComparePy << " (libbenchmark-tools)";
  const TemporaryFolder folder;
  const Experiment before = filledExperiment(folder.path() / "before", 1);
  const Experiment after = filledExperiment(folder.path() / "after", 2);
  const auto [status, output] = runPython(folder.path(),
                                          "import runpy, sys\nsys.argv = sys.argv[1:]\n"
                                          "sys.path.insert(0, '/usr/share/benchmark')\n"
                                          "runpy.run_path(sys.argv[0], run_name='__main__')\n",
                                          fmt::format("{} --no-color benchmarks '{}' '{}'", kComparePy,
                                                      (before.folder() / "google_benchmark.json").string(),
                                                      (after.folder() / "google_benchmark.json").string()));
  EXPECT_EQ(status, 0) << output;
  EXPECT_THAT(output, testing::ContainsRegex("quick/technique:fake_a/step:0.5_mean +\\+1.0000 +\\+1.0000"));
  EXPECT_THAT(output, HasSubstr("quick/technique:fake_b/step:0.5_pvalue"));
  EXPECT_EQ(output.find("Traceback"), std::string::npos) << output;
}

TEST(GoogleBenchmark, ofNoRunsIsEmpty) {
  const TemporaryFolder folder;
  const Experiment experiment(folder.path(), makeScenario());
  experiment.writeIndex();
  EXPECT_EQ(readJson(experiment.folder() / "google_benchmark.json")->at("benchmarks").size(), 0u);
  EXPECT_THAT(readText(experiment.folder() / "index.csv"), HasSubstr("# volmark.index 1\nrun,point,"));
}

} // namespace
} // namespace volmark::results_test
