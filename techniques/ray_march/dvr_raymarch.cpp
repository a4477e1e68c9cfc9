#include "dvr_raymarch.h"

#include "marcher.h"
#include "transfer_table.h"

#include <optional>

namespace volmark::ray_march {

namespace {

constexpr VkFormat kTableFormat = VK_FORMAT_R32G32B32A32_SFLOAT;

bool isPreintegrated(const ParameterValues& parameters) {
  return parameters.text("transfer_function_kind") == "preintegrated";
}

class DvrRaymarch final : public Technique {
public:
  void prepare(const Preparation& preparation, Recorder& recorder) override;
  void reset(std::uint64_t seed) override { m_seed = seed; }
  void update(const Changes& changes, const FrameInputs& inputs, Recorder& recorder) override;
  void draw(const Frame& frame, Recorder& recorder) override;
  std::vector<CounterValue> counters() const override;
  std::vector<gpu::MemoryItem> memory() const override { return m_memory; }

private:
  std::optional<Marcher> m_marcher;
  bool m_preintegrated = false;
  int m_tableSize = 0;
  double m_step = 1;
  gpu::Image m_table;
  gpu::Sampler m_tableSampler;
  MarchConstants m_constants{};
  std::uint64_t m_seed = 0;
  std::vector<gpu::MemoryItem> m_memory;
};

void DvrRaymarch::prepare(const Preparation& preparation, Recorder& recorder) {
  const ParameterValues& parameters = preparation.parameters;
  gpu::Device& device = *preparation.device;
  const std::vector<gpu::MemoryItem> before = device.ledger().items();
  m_step = parameters.number("step");
  m_preintegrated = isPreintegrated(parameters);
  m_tableSize = static_cast<int>(parameters.integer(m_preintegrated ? "preintegrated_size" : "table_size"));
  m_constants.endTransmittance = static_cast<float>(1 - parameters.number("termination_opacity"));

  MarcherDescription description{.shader = {.path = "ray_march/dvr_raymarch.comp.glsl"},
                                 .own = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER};
  if (m_preintegrated) description.shader.macros.emplace_back("PREINTEGRATED", "1");
  description.variant.set(kIdEarlyTermination, parameters.boolean("early_termination"));
  m_marcher.emplace(preparation, description, recorder);

  const auto size = static_cast<std::uint32_t>(m_tableSize);
  m_table = gpu::Image(device, {.name = "transfer_function",
                                .type = m_preintegrated ? VK_IMAGE_TYPE_2D : VK_IMAGE_TYPE_1D,
                                .format = kTableFormat,
                                .extent = {size, m_preintegrated ? size : 1, 1},
                                .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT});
  m_tableSampler = gpu::Sampler(device, m_preintegrated ? VK_FILTER_LINEAR : VK_FILTER_NEAREST);
  m_memory = memoryAdded(before, device.ledger().items());
}

void DvrRaymarch::update(const Changes& changes, const FrameInputs& inputs, Recorder& recorder) {
  if (!changes.transferFunction) return;
  TransferTable table;
  {
    const Pass pass = recorder.hostPass("build_transfer_function");
    table = (m_preintegrated ? preintegratedTable : postClassifiedTable)(*inputs.transferFunction, m_tableSize, m_step);
  }
  m_constants.visibleLow = table.visibleLow;
  m_constants.visibleHigh = table.visibleHigh;
  // Entry i lies at scalar i/(size-1) and at table coordinate (i+0.5)/size.
  m_constants.tableScale = static_cast<float>(m_tableSize - 1) / static_cast<float>(m_tableSize);
  m_constants.tableBias = 0.5f / static_cast<float>(m_tableSize);
  const Pass pass = recorder.pass("upload_transfer_function");
  recorder.gpu().upload(m_table, std::as_bytes(std::span(table.entries)));
}

void DvrRaymarch::draw(const Frame& frame, Recorder& recorder) {
  const gpu::Resource table = gpu::SampledImage{m_table.layerView(0), m_tableSampler.handle()};
  m_marcher->march(frame, m_seed, m_constants, table, recorder);
}

std::vector<CounterValue> DvrRaymarch::counters() const {
  const std::vector<std::uint64_t> counts = m_marcher->counts();
  return {{"samples", counts[kCounterSamples]},
          {"rays", counts[kCounterRays]},
          {"terminated_rays", counts[kCounterEnded]},
          {"gradients", counts[kCounterGradients]}};
}

std::vector<ParameterDescriptor> parameterDescriptors() {
  return {stepParameter(1),
          ParameterDescriptor::choice("transfer_function_kind", "post", {"post", "preintegrated"},
                                      "Colour and opacity of each sample, or of the slab between two samples."),
          ParameterDescriptor::integer("table_size", 4096, 16, 4096, "", "Entries of the 1-D table (post)."),
          ParameterDescriptor::integer("preintegrated_size", 256, 16, 512, "",
                                       "Rows and columns of the 2-D table (preintegrated)."),
          ParameterDescriptor::boolean("early_termination", true, "End a ray that has become opaque."),
          ParameterDescriptor::number("termination_opacity", 0.99, 0.5, 1, "", "Opacity that ends a ray."),
          filteringParameter(),
          jitterParameter()};
}

TechniqueInfo describe() {
  return {.name = "dvr_raymarch",
          .summary = "Emission and absorption, front to back in fixed steps, without empty-space skipping.",
          .paper = "Faludi, Zentai, Zelechowski, Zam, Rauter, Griessen, Cattin: Transfer-Function-Independent "
                   "Acceleration Structure for Volume Rendering in Virtual Reality, 2021",
          .section = "3.2 and the column \"None\" of table 1",
          .draws = Draws::volume,
          .maximumViews = gpu::kMaxViews,
          .shadings = {ShadingModel::none, ShadingModel::lambert, ShadingModel::phong, ShadingModel::gooch},
          .parameters = parameterDescriptors(),
          .passes = {{"build_transfer_function", "The table on the host, when the transfer function has changed."},
                     {"upload_transfer_function", "The table to the GPU."},
                     {"march", "All rays of all views."}},
          .generation = {{"upload", "The volume's voxels to the GPU."},
                         {"pipelines", "The timed and the counting pipeline."}},
          .counters = counterDescriptors("terminated_rays", "Rays that end before the exit because they are opaque."),
          .layers = {PictureLayer::steps}};
}

std::optional<std::string> whyDvrUnsupported(const Scene& scene, const ParameterValues& parameters,
                                             const OutputSize& size, const gpu::Device* device) {
  if (isPreintegrated(parameters) && !device->filtersLinearly(kTableFormat))
    return "The device can't filter the pre-integrated table (R32G32B32A32_SFLOAT) linearly.";
  return whyUnsupported(scene, parameters, size, device);
}

} // namespace

TechniqueFactory dvrRaymarch() {
  return {.info = describe(),
          .create = []() -> std::unique_ptr<Technique> { return std::make_unique<DvrRaymarch>(); },
          .whyUnsupported = whyDvrUnsupported};
}

} // namespace volmark::ray_march
