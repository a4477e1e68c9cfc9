// Pictures: errors per megapixel, and writing EXR.
#include "bench/bench_files.h"
#include "image/exr.h"
#include "image/flip.h"
#include "image/metrics.h"
#include "image/plane.h"
#include "image/ssim.h"

#include <benchmark/benchmark.h>

namespace volmark::bench {
namespace {

constexpr int kSide = 1024; // 1.05 megapixels

void perMegapixel(benchmark::State& state) {
  state.counters["megapixels_per_second"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * kSide * kSide / 1e6, benchmark::Counter::kIsRate);
}

Plane plane(double seed) {
  const Picture source = picture(kSide, kSide, seed);
  Plane result(kSide, kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      result.row(y)[x] = source.color[source.index(x, y)].x;
  return result;
}

void allColourErrors(benchmark::State& state) {
  const Picture a = picture(kSide, kSide, 0);
  const Picture b = picture(kSide, kSide, 0.1);
  for (auto _ : state)
    benchmark::DoNotOptimize(compareColor(a, b, glm::dvec3(0)).flip);
  perMegapixel(state);
}
BENCHMARK(allColourErrors)->Unit(benchmark::kMillisecond)->UseRealTime();

void ssim(benchmark::State& state) {
  const Plane a = plane(0);
  const Plane b = plane(0.1);
  for (auto _ : state)
    benchmark::DoNotOptimize(meanSsim(ssimMap(a, b)));
  perMegapixel(state);
}
BENCHMARK(ssim)->Unit(benchmark::kMillisecond)->UseRealTime();

void flip(benchmark::State& state) {
  const Planes a = {plane(0), plane(1), plane(2)};
  const Planes b = {plane(0.1), plane(1.1), plane(2.1)};
  for (auto _ : state)
    benchmark::DoNotOptimize(flipMap(a, b).row(0));
  perMegapixel(state);
}
BENCHMARK(flip)->Unit(benchmark::kMillisecond)->UseRealTime();

void writePicture(benchmark::State& state) {
  const std::vector<Picture> pictures = {picture(kSide, kSide, 0)};
  for (auto _ : state)
    writeExr(folder() / "picture.exr", pictures, {});
  perMegapixel(state);
}
BENCHMARK(writePicture)->Unit(benchmark::kMillisecond)->UseRealTime();

} // namespace
} // namespace volmark::bench
