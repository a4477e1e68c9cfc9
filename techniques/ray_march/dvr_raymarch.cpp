#include "dvr_raymarch.h"

#include "parts/volume_marcher.h"

#include <optional>

namespace volmark::ray_march {

namespace {

class DvrRaymarch final : public Technique {
public:
  void prepare(const Preparation& preparation, Recorder& recorder) override {
    const std::vector<gpu::MemoryItem> before = preparation.device->ledger().items();
    m_marcher.emplace(preparation, parts::VolumeMarcherDescription{.shader = "ray_march/dvr_raymarch.comp.glsl"},
                      recorder);
    m_memory = parts::memoryAdded(before, preparation.device->ledger().items());
  }
  void reset(std::uint64_t seed) override { m_seed = seed; }
  void update(const Changes& changes, const FrameInputs& inputs, Recorder& recorder) override {
    m_marcher->update(changes, inputs, recorder);
  }
  void draw(const Frame& frame, Recorder& recorder) override { m_marcher->draw(frame, m_seed, {}, recorder); }
  std::vector<CounterValue> counters() const override { return parts::emissionCounterValues(m_marcher->counts()); }
  std::vector<gpu::MemoryItem> memory() const override { return m_memory; }

private:
  std::optional<parts::VolumeMarcher> m_marcher;
  std::uint64_t m_seed = 0;
  std::vector<gpu::MemoryItem> m_memory;
};

TechniqueInfo describe() {
  return {.name = "dvr_raymarch",
          .summary = "Emission and absorption, front to back in fixed steps, without empty-space skipping.",
          .paper = "Faludi, Zentai, Zelechowski, Zam, Rauter, Griessen, Cattin: Transfer-Function-Independent "
                   "Acceleration Structure for Volume Rendering in Virtual Reality, 2021",
          .section = "3.2 and the column \"None\" of table 1",
          .draws = Draws::volume,
          .maximumViews = gpu::kMaxViews,
          .shadings = parts::emissionShadings(),
          .shadows = true,
          .functionBeyond = true,
          .segments = true,
          .parameters = parts::emissionParameters(),
          .passes = parts::emissionPasses(),
          .generation = parts::emissionGeneration(),
          .counters = parts::emissionCounters(),
          .layers = {PictureLayer::steps}};
}

} // namespace

TechniqueFactory dvrRaymarch() {
  return {.info = describe(),
          .create = []() -> std::unique_ptr<Technique> { return std::make_unique<DvrRaymarch>(); },
          .whyUnsupported = parts::whyEmissionUnsupported};
}

} // namespace volmark::ray_march
