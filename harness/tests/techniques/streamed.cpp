#include "test_techniques.h"
#include "volmark/gpu/frame_constants.h"
#include "volmark/gpu/target.h"

#include <array>
#include <optional>

namespace volmark::test {

namespace {

class Streamed : public Technique {
public:
  void prepare(const Preparation& preparation, Recorder& recorder) override {
    m_scene = &preparation.scene;
    m_size = preparation.size;
    m_texture.emplace(*preparation.device, *m_scene, gpu::Filtering::shader, recorder);
    const auto pass = recorder.hostPass("pipelines");
    m_pipeline = gpu::Pipeline(
        *preparation.device,
        gpu::ComputePipelineDescription{"slice",
                                        {"test_techniques/slice.comp.glsl"},
                                        {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                          VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE}}});
  }

  void reset(std::uint64_t) override {}

  void update(const Changes& changes, const FrameInputs& inputs, Recorder& recorder) override {
    if (!changes.timeStep) return;
    const auto pass = recorder.pass("upload");
    m_texture->upload(recorder.gpu(), *m_scene->volume, inputs.timeStep, 0);
  }

  void draw(const Frame& frame, Recorder& recorder) override {
    const auto pass = recorder.pass("slice");
    gpu::Commands& commands = recorder.gpu();
    const auto constants = commands.constants(gpu::frameConstants(frame, *m_scene, *m_texture, 0));
    const std::array<gpu::Resource, 4> resources{constants, m_texture->slot(0),
                                                 gpu::StorageImage{frame.target->color.view()},
                                                 gpu::StorageImage{frame.target->distance.view()}};
    commands.dispatch(m_pipeline, resources, {}, {(m_size.width + 7) / 8, (m_size.height + 7) / 8, m_size.views});
  }

  std::vector<gpu::MemoryItem> memory() const override { return {m_texture->memory()}; }

private:
  const Scene* m_scene = nullptr;
  OutputSize m_size;
  std::optional<gpu::VolumeTexture> m_texture;
  gpu::Pipeline m_pipeline;
};

} // namespace

TechniqueFactory streamedFactory() {
  TechniqueInfo info;
  info.name = "test_streamed";
  info.summary = "Shows a slice of the current time step, streamed when it changes";
  info.draws = Draws::both;
  info.shadings = {ShadingModel::none};
  info.passes = {{"upload", "copies the new time step"}, {"slice", "draws it"}};
  info.generation = {{"upload", "copies the first time step"}, {"pipelines", "compiles the shader"}};
  return {info, []() -> std::unique_ptr<Technique> { return std::make_unique<Streamed>(); }};
}

} // namespace volmark::test
