// Opening volumes: per format, against plain reading of the same bytes; and what every volume costs then.
#include "bench/bench_files.h"
#include "volume/histogram.h"
#include "volume/raw.h"
#include "volume/volume_file.h"
#include "volume/voxel_file.h"

#include <benchmark/benchmark.h>

namespace volmark::bench {
namespace {

constexpr std::uint64_t kNoLimit = std::uint64_t(1) << 40;

void setBytes(benchmark::State& state) {
  state.SetBytesProcessed(state.iterations() * state.range(0) * state.range(0) * state.range(0));
}

/// The floor: the bytes of the raw file into memory.
void readPlain(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  const auto path = volumeFile(".raw", side);
  for (auto _ : state)
    benchmark::DoNotOptimize(readVoxels(path, 0, std::uint64_t(side) * side * side).data());
  setBytes(state);
}
BENCHMARK(readPlain)->Arg(256)->Arg(512)->Unit(benchmark::kMillisecond)->UseRealTime();

void load(benchmark::State& state, const std::string& form) {
  const auto path = volumeFile(form, static_cast<int>(state.range(0)));
  for (auto _ : state)
    benchmark::DoNotOptimize(loadVolumeFile(path, kNoLimit)->dataRange());
  setBytes(state);
}
BENCHMARK_CAPTURE(load, nrrd, ".nrrd")->Arg(256)->Arg(512)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(load, nrrd_gzip, ".nrrd gzip")->Arg(256)->Arg(512)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(load, mha, ".mha")->Arg(256)->Arg(512)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(load, nii, ".nii")->Arg(256)->Arg(512)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(load, nii_gz, ".nii.gz")->Arg(256)->Arg(512)->Unit(benchmark::kMillisecond)->UseRealTime();

void loadHeaderless(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  const auto path = volumeFile(".raw", side);
  const RawDescription description{Grid{glm::ivec3(side), glm::dvec3(1)}, ScalarType::uint8, false, 0, 1};
  for (auto _ : state)
    benchmark::DoNotOptimize(loadRaw(path, description, kNoLimit)->dataRange());
  setBytes(state);
}
BENCHMARK(loadHeaderless)->Arg(256)->Arg(512)->Unit(benchmark::kMillisecond)->UseRealTime();

/// Normalising: the range of all voxels and their identity, once per opened volume.
void rangeAndIdentity(benchmark::State& state) {
  const auto source = volume(static_cast<int>(state.range(0)));
  const std::shared_ptr<const void> owner = source;
  for (auto _ : state) {
    const Volume again("again", source->grid(), source->type(), SharedBytes(owner, source->voxels()));
    benchmark::DoNotOptimize(again.dataRange());
  }
  setBytes(state);
}
BENCHMARK(rangeAndIdentity)->Arg(256)->Unit(benchmark::kMillisecond);

void histogram(benchmark::State& state) {
  const auto source = volume(static_cast<int>(state.range(0)));
  for (auto _ : state)
    benchmark::DoNotOptimize(histogramOf(*source, 256).mean);
  setBytes(state);
}
BENCHMARK(histogram)->Arg(256)->Unit(benchmark::kMillisecond);

} // namespace
} // namespace volmark::bench
