#include "test_techniques.h"
#include "volmark/gpu/frame_constants.h"
#include "volmark/gpu/target.h"

#include <array>
#include <optional>

namespace volmark::test {

namespace {

class Lossless : public Technique {
public:
  void prepare(const Preparation& preparation, Recorder& recorder) override {
    m_scene = &preparation.scene;
    m_size = preparation.size;
    m_texture.emplace(*preparation.device, *m_scene, gpu::Filtering::shader, recorder);
    const auto pass = recorder.hostPass("pipelines");
    const auto pixels = static_cast<VkDeviceSize>(m_size.width) * m_size.height * m_size.views;
    m_cache = gpu::Buffer(*preparation.device, {"cache", pixels * 4, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT});
    m_recompute = gpu::Pipeline(
        *preparation.device,
        gpu::ComputePipelineDescription{"recompute",
                                        {"test_techniques/recompute.comp.glsl"},
                                        {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER}}});
    m_show = gpu::Pipeline(
        *preparation.device,
        gpu::ComputePipelineDescription{"show_cache",
                                        {"test_techniques/show_cache.comp.glsl"},
                                        {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                          VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE}}});
  }

  void reset(std::uint64_t seed) override {
    m_seed = seed;
    m_stale = true;
  }

  void update(const Changes& changes, const FrameInputs&, Recorder&) override {
    m_stale = m_stale || changes.camera || changes.clippingPlanes;
  }

  void draw(const Frame& frame, Recorder& recorder) override {
    gpu::Commands& commands = recorder.gpu();
    const auto constants = commands.constants(gpu::frameConstants(frame, *m_scene, *m_texture, m_seed));
    const gpu::BufferRange cache = m_cache.range();
    const glm::uvec3 groups{(m_size.width + 7) / 8, (m_size.height + 7) / 8, m_size.views};
    m_recomputed = m_stale ? static_cast<std::uint64_t>(m_size.width) * m_size.height * m_size.views : 0;
    if (m_stale) {
      const auto pass = recorder.pass("recompute");
      commands.barrier(gpu::kComputeRead, gpu::kComputeWrite);
      const std::array<gpu::Resource, 2> resources{constants, cache};
      commands.dispatch(m_recompute, resources, {}, groups);
      commands.barrier(gpu::kComputeWrite, gpu::kComputeRead);
      m_stale = false;
    }
    const auto pass = recorder.pass("show");
    const std::array<gpu::Resource, 4> resources{constants, cache, gpu::StorageImage{frame.target->color.view()},
                                                 gpu::StorageImage{frame.target->distance.view()}};
    commands.dispatch(m_show, resources, {}, groups);
  }

  std::vector<CounterValue> counters() const override { return {{"recomputed", m_recomputed}}; }

  std::vector<gpu::MemoryItem> memory() const override { return {m_cache.memory(), m_texture->memory()}; }

private:
  const Scene* m_scene = nullptr;
  OutputSize m_size;
  std::optional<gpu::VolumeTexture> m_texture;
  gpu::Buffer m_cache;
  gpu::Pipeline m_recompute;
  gpu::Pipeline m_show;
  std::uint64_t m_seed = 0;
  std::uint64_t m_recomputed = 0;
  bool m_stale = true;
};

} // namespace

TechniqueFactory losslessFactory() {
  TechniqueInfo info;
  info.name = "test_lossless";
  info.summary = "Shows how long each ray is inside the box; recomputes only when the camera moved";
  info.draws = Draws::both;
  info.history = History::lossless;
  info.shadings = {ShadingModel::none};
  info.passes = {{"recompute", "fills the cache"}, {"show", "draws from the cache"}};
  info.generation = {{"upload", "copies the volume"}, {"pipelines", "compiles the shaders"}};
  info.counters = {{"recomputed", CounterKind::exact, "pixels recomputed"}};
  return {info, []() -> std::unique_ptr<Technique> { return std::make_unique<Lossless>(); }};
}

} // namespace volmark::test
