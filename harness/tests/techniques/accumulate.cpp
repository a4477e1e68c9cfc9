#include "test_techniques.h"
#include "volmark/gpu/commands.h"
#include "volmark/gpu/target.h"

#include <array>

namespace volmark::test {

namespace {

struct Push {
  glm::ivec2 size;
  std::uint32_t frameIndex;
  std::uint32_t seed;
};
static_assert(sizeof(Push) == 16);

class Accumulate : public Technique {
public:
  void prepare(const Preparation& preparation, Recorder& recorder) override {
    const auto pass = recorder.hostPass("pipelines");
    m_size = preparation.size;
    const auto pixels = static_cast<VkDeviceSize>(m_size.width) * m_size.height * m_size.views;
    m_sums = gpu::Buffer(*preparation.device, {"sums", pixels * 4, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT});
    m_pipeline = gpu::Pipeline(
        *preparation.device,
        gpu::ComputePipelineDescription{
            "accumulate",
            {"test_techniques/accumulate.comp.glsl"},
            {{VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
             sizeof(Push)}});
  }

  void reset(std::uint64_t seed) override { m_seed = static_cast<std::uint32_t>(seed); }

  void update(const Changes&, const FrameInputs&, Recorder&) override {}

  void draw(const Frame& frame, Recorder& recorder) override {
    const auto pass = recorder.pass("accumulate");
    gpu::Commands& commands = recorder.gpu();
    // The sums of the previous frame, which may still be in flight.
    commands.barrier(gpu::kComputeWrite, gpu::kComputeReadWrite);
    const std::array<gpu::Resource, 3> resources{gpu::StorageImage{frame.target->color.view()},
                                                 gpu::StorageImage{frame.target->distance.view()}, m_sums.range()};
    const Push push{{m_size.width, m_size.height}, static_cast<std::uint32_t>(frame.index), m_seed};
    commands.dispatch(m_pipeline, resources, gpu::bytesOf(push),
                      {(m_size.width + 7) / 8, (m_size.height + 7) / 8, m_size.views});
  }

  std::vector<gpu::MemoryItem> memory() const override { return {m_sums.memory()}; }

private:
  OutputSize m_size;
  gpu::Buffer m_sums;
  gpu::Pipeline m_pipeline;
  std::uint32_t m_seed = 0;
};

} // namespace

TechniqueFactory accumulateFactory() {
  TechniqueInfo info;
  info.name = "test_accumulate";
  info.summary = "Shows the mean of noise over the frames since reset";
  info.draws = Draws::both;
  info.history = History::visible;
  info.shadings = {ShadingModel::none};
  info.passes = {{"accumulate", "adds one sample and shows the mean"}};
  info.generation = {{"pipelines", "compiles the shader"}};
  return {info, []() -> std::unique_ptr<Technique> { return std::make_unique<Accumulate>(); }};
}

} // namespace volmark::test
