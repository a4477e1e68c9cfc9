#include "iso_raymarch.h"

#include "parts/marcher.h"
#include "volmark/gpu/target.h"

#include <optional>

namespace volmark::ray_march {

using namespace parts;

namespace {

class IsoRaymarch final : public Technique {
public:
  void prepare(const Preparation& preparation, Recorder& recorder) override {
    const std::vector<gpu::MemoryItem> before = preparation.device->ledger().items();
    m_bisections = static_cast<std::uint32_t>(preparation.parameters.integer("bisections"));
    m_marcher.emplace(preparation, recorder);
    {
      const Pass pass = recorder.hostPass("pipelines");
      m_pipelines = m_marcher->makePipelines(preparation, {.shader = {.path = "ray_march/iso_raymarch.comp.glsl"},
                                                           .own = {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE}});
    }
    m_memory = memoryAdded(before, preparation.device->ledger().items());
  }

  void reset(std::uint64_t seed) override { m_seed = seed; }

  void update(const Changes&, const FrameInputs&, Recorder&) override {}

  void draw(const Frame& frame, Recorder& recorder) override {
    const gpu::Resource normals[] = {gpu::StorageImage{frame.target->normal.view()}};
    m_marcher->beginFrame(frame, recorder);
    m_marcher->march(m_pipelines, frame, m_seed, MarchConstants{.bisections = m_bisections}, normals, recorder);
  }

  std::vector<CounterValue> counters() const override {
    const std::vector<std::uint64_t> counts = m_marcher->counts();
    return {{"samples", counts[kCounterSamples]},
            {"rays", counts[kCounterRays]},
            {"hits", counts[kCounterEnded]},
            {"gradients", counts[kCounterGradients]}};
  }

  std::vector<gpu::MemoryItem> memory() const override { return m_memory; }

private:
  std::optional<Marcher> m_marcher;
  MarchPipelines m_pipelines;
  std::uint32_t m_bisections = 0;
  std::uint64_t m_seed = 0;
  std::vector<gpu::MemoryItem> m_memory;
};

TechniqueInfo describe() {
  return {.name = "iso_raymarch",
          .summary = "Isosurface by marching every pixel's ray in fixed steps and bisecting the first crossing.",
          .paper = "Nysjö, Malmberg, Nyström: RayCaching: Amortized Isosurface Rendering for Virtual Reality, 2019",
          .section = "4, \"direct isosurface raycasting\" (DIR); the march itself: 3.1",
          .draws = Draws::isosurface,
          .maximumViews = gpu::kMaxViews,
          .shadings = {ShadingModel::lambert, ShadingModel::none, ShadingModel::phong, ShadingModel::gooch,
                       ShadingModel::ggx},
          .parameters = {stepParameter(0.5),
                         ParameterDescriptor::integer("bisections", 6, 0, 16, "",
                                                      "Halvings of the interval that holds the crossing."),
                         filteringParameter(), jitterParameter()},
          .passes = {{"march", "All rays of all views, shaded."}},
          .generation = {{"upload", "The volume's voxels to the GPU."},
                         {"pipelines", "The timed and the counting pipeline."}},
          .counters = counterDescriptors("hits", "Rays that meet the isosurface."),
          .layers = {PictureLayer::normal, PictureLayer::steps}};
}

} // namespace

TechniqueFactory isoRaymarch() {
  return {.info = describe(),
          .create = []() -> std::unique_ptr<Technique> { return std::make_unique<IsoRaymarch>(); },
          .whyUnsupported = whyUnsupported};
}

} // namespace volmark::ray_march
