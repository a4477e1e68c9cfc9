#include "test_techniques.h"
#include "volmark/gpu/commands.h"
#include "volmark/gpu/target.h"
#include "volmark/shared/frame_constants.h"

#include <array>

namespace volmark::test {

namespace {

struct Views {
  std::array<gpu::ViewConstants, gpu::kMaxViews> views;
};

class AsymmetricStereo : public Technique {
public:
  void prepare(const Preparation& preparation, Recorder& recorder) override {
    const auto pass = recorder.hostPass("pipelines");
    m_size = preparation.size;
    m_pipeline = gpu::Pipeline(
        *preparation.device,
        gpu::ComputePipelineDescription{
            "directions",
            {"test_techniques/directions.comp.glsl"},
            {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE},
             sizeof(glm::ivec2)}});
  }

  void reset(std::uint64_t) override {}
  void update(const Changes&, const FrameInputs&, Recorder&) override {}

  void draw(const Frame& frame, Recorder& recorder) override {
    const auto pass = recorder.pass("directions");
    Views views{};
    for (const View& view : frame.inputs.views) {
      const Frustum& f = view.frustum;
      views.views.at(static_cast<std::size_t>(view.layer)) = {
          view.pose.position, view.pose.right, view.pose.up, view.pose.forward, {f.left, f.right, f.down, f.up}};
    }
    gpu::Commands& commands = recorder.gpu();
    const std::array<gpu::Resource, 3> resources{commands.constants(views),
                                                 gpu::StorageImage{frame.target->color.view()},
                                                 gpu::StorageImage{frame.target->distance.view()}};
    const glm::ivec2 size{m_size.width, m_size.height};
    commands.dispatch(m_pipeline, resources, gpu::bytesOf(size),
                      {(m_size.width + 7) / 8, (m_size.height + 7) / 8, m_size.views});
  }

  std::vector<gpu::MemoryItem> memory() const override { return {}; }

private:
  OutputSize m_size;
  gpu::Pipeline m_pipeline;
};

} // namespace

TechniqueFactory asymmetricStereoFactory() {
  TechniqueInfo info;
  info.name = "test_asymmetric_stereo";
  info.summary = "Shows ray directions of each view";
  info.draws = Draws::both;
  info.shadings = {ShadingModel::none};
  info.passes = {{"directions", "one pixel, one ray"}};
  info.generation = {{"pipelines", "compiles the shader"}};
  return {info, []() -> std::unique_ptr<Technique> { return std::make_unique<AsymmetricStereo>(); }};
}

} // namespace volmark::test
