// The technique to copy: the smallest one that draws something. Read volmark/technique.h beside it.
#include "volmark/gpu/frame_constants.h"
#include "volmark/gpu/target.h"
#include "volmark/module.h"

#include <array>
#include <optional>

namespace {

using namespace volmark;

class BoxDepth : public Technique {
public:
  // Everything that stays the same while the technique lives. Each step is a pass of its own.
  void prepare(const Preparation& preparation, Recorder& recorder) override {
    m_scene = &preparation.scene;
    m_size = preparation.size;
    m_texture.emplace(*preparation.device, *m_scene, gpu::Filtering::shader, recorder); // pass "upload"

    const auto pass = recorder.hostPass("pipelines");
    gpu::ComputePipelineDescription description;
    description.name = "box_depth";
    description.shader.path = "box_depth/box_depth.comp.glsl";
    description.layout.bindings = {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
                                   VK_DESCRIPTOR_TYPE_STORAGE_IMAGE};
    description.specialisation.set(0, static_cast<float>(preparation.parameters.number("brightness")));
    m_pipeline = gpu::Pipeline(*preparation.device, description);
  }

  // A technique without history keeps only the seed.
  void reset(std::uint64_t seed) override { m_seed = seed; }

  // What depends on isovalue, transfer function or camera is rebuilt here, in passes of its own.
  void update(const Changes&, const FrameInputs&, Recorder&) override {}

  void draw(const Frame& frame, Recorder& recorder) override {
    const auto pass = recorder.pass("box");
    gpu::Commands& commands = recorder.gpu();
    const std::array<gpu::Resource, 3> resources{
        commands.constants(gpu::frameConstants(frame, *m_scene, *m_texture, m_seed)),
        gpu::StorageImage{frame.target->color.view()}, gpu::StorageImage{frame.target->distance.view()}};
    commands.dispatch(m_pipeline, resources, {}, {(m_size.width + 7) / 8, (m_size.height + 7) / 8, m_size.views});
  }

  // The harness compares the sum with what the device's allocator saw.
  std::vector<gpu::MemoryItem> memory() const override { return {m_texture->memory()}; }

private:
  const Scene* m_scene = nullptr;
  OutputSize m_size;
  std::optional<gpu::VolumeTexture> m_texture;
  gpu::Pipeline m_pipeline;
  std::uint64_t m_seed = 0;
};

TechniqueFactory boxDepthFactory() {
  TechniqueInfo info;
  info.name = "box_depth";
  info.summary = "Colours the volume's box by how long each ray is inside it";
  info.draws = Draws::both;
  info.shadings = {ShadingModel::none};
  info.parameters = {ParameterDescriptor::number("brightness", 1, 0, 10, "", "Factor of the colour")};
  info.passes = {{"box", "one ray per pixel"}};
  info.generation = {{"upload", "copies the volume"}, {"pipelines", "compiles the shader"}};
  return {info, []() -> std::unique_ptr<Technique> { return std::make_unique<BoxDepth>(); }};
}

} // namespace

VOLMARK_MODULE(box_depth, boxDepthFactory())
