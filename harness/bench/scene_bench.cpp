// The reference's rays, expansion of a large grid, and the ray marchers' kernels.
#include "bench/bench_files.h"
#include "reference/reference.h"
#include "scenario/scenario.h"
#include "timeline/timeline.h"
#include "volmark/error.h"
#include "worker/session.h"

#include <benchmark/benchmark.h>
#include <fstream>

namespace volmark::bench {
namespace {

constexpr int kSide = 256;

const TechniqueCatalogue& catalogue() {
  static const TechniqueCatalogue loaded({VOLMARK_BINARY_DIR "/techniques"});
  return loaded;
}

Point pointOf(const std::string& technique) {
  return makePoint({{"technique.name", technique}, {"scene", "marschner_lobb"}, {"resolution", {kSide, kSide}}}, {},
                   catalogue(), VOLMARK_SOURCE_DIR "/scenes");
}

void raysPerSecond(benchmark::State& state) {
  state.counters["rays_per_second"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * kSide * kSide, benchmark::Counter::kIsRate);
}

void referenceIsosurface(benchmark::State& state) {
  const Point point = pointOf("iso_raymarch");
  const Scene scene = makeScene(point.settings, openVolume(point.settings.scene, {}, 1u << 30));
  const FrameInputs inputs = Timeline(point.settings, scene).at(0.1);
  for (auto _ : state)
    benchmark::DoNotOptimize(reference::renderIsosurface(scene, inputs, 0, kSide, kSide).color.data());
  raysPerSecond(state);
}
BENCHMARK(referenceIsosurface)->Unit(benchmark::kMillisecond)->UseRealTime();

/// 10,000 points: 100 steps by 100 isovalues.
void expandGrid(benchmark::State& state) {
  nlohmann::json steps = nlohmann::json::array();
  nlohmann::json isovalues = nlohmann::json::array();
  for (int i = 0; i < 100; ++i) {
    steps.push_back(0.1 + 0.01 * i);
    isovalues.push_back({{"normalized", 0.005 + 0.009 * i}});
  }
  const nlohmann::json document = {{"volmark", 1},
                                   {"name", "grid"},
                                   {"set", {{"scene", "marschner_lobb"}, {"technique.name", "iso_raymarch"}}},
                                   {"blocks",
                                    {{{"axes",
                                       {{"step", {{"path", "technique.parameters.step"}, {"values", steps}}},
                                        {"isovalue", {{"path", "isovalue"}, {"values", isovalues}}}}}}}}};
  const auto file = folder() / "grid.json";
  std::ofstream(file) << document;
  const ScenarioOptions options{file, "", {}, VOLMARK_SOURCE_DIR "/scenes", VOLMARK_SOURCE_DIR "/configs/profiles"};
  for (auto _ : state)
    benchmark::DoNotOptimize(readScenario(options, catalogue()).points.size());
  state.counters["points_per_second"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * 10000, benchmark::Counter::kIsRate);
}
BENCHMARK(expandGrid)->Unit(benchmark::kMillisecond);

/// One frame, host time, on the device that is chosen by itself.
void drawFrame(benchmark::State& state, const std::string& technique) {
  const Point point = pointOf(technique);
  try {
    Session session(point.settings, catalogue().get(technique), openVolume(point.settings.scene, {}, 1u << 30), {});
    session.prepare();
    session.reset();
    std::uint64_t frame = 0;
    session.draw(0, frame++, StampMode::headline); // the first use of a pipeline compiles it
    for (auto _ : state)
      benchmark::DoNotOptimize(session.draw(0.1, frame++, StampMode::headline).endMs);
    raysPerSecond(state);
  } catch (const UnsupportedError& error) {
    state.SkipWithError(error.what());
  }
}
BENCHMARK_CAPTURE(drawFrame, iso_raymarch, "iso_raymarch")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(drawFrame, dvr_raymarch, "dvr_raymarch")->Unit(benchmark::kMillisecond)->UseRealTime();

} // namespace
} // namespace volmark::bench
