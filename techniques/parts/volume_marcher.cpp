#include "parts/volume_marcher.h"

namespace volmark::parts {

namespace {

constexpr VkFormat kTableFormat = VK_FORMAT_R32G32B32A32_SFLOAT;

bool asksForPreintegration(const ParameterValues& parameters) {
  return parameters.text("transfer_function_kind") == "preintegrated";
}

} // namespace

MarcherDescription VolumeMarcher::marcherDescription(const ParameterValues& parameters,
                                                     const VolumeMarcherDescription& description) {
  MarcherDescription result{.shader = {.path = description.shader, .macros = description.macros},
                            .variant = description.variant,
                            .own = {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER}};
  if (asksForPreintegration(parameters)) result.shader.macros.emplace_back("PREINTEGRATED", "1");
  result.variant.set(kIdEarlyTermination, parameters.boolean("early_termination"));
  result.own.insert(result.own.end(), description.own.begin(), description.own.end());
  return result;
}

VolumeMarcher::VolumeMarcher(const Preparation& preparation, const VolumeMarcherDescription& description,
                             Recorder& recorder)
    : m_step(preparation.parameters.number("step")), m_preintegrated(asksForPreintegration(preparation.parameters)),
      m_tableSize(
          static_cast<int>(preparation.parameters.integer(m_preintegrated ? "preintegrated_size" : "table_size"))),
      m_marcher(preparation, marcherDescription(preparation.parameters, description), recorder) {
  const auto size = static_cast<std::uint32_t>(m_tableSize);
  m_tableImage =
      gpu::Image(*preparation.device, {.name = "transfer_function",
                                       .type = m_preintegrated ? VK_IMAGE_TYPE_2D : VK_IMAGE_TYPE_1D,
                                       .format = kTableFormat,
                                       .extent = {size, m_preintegrated ? size : 1, 1},
                                       .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT});
  m_tableSampler = gpu::Sampler(*preparation.device, m_preintegrated ? VK_FILTER_LINEAR : VK_FILTER_NEAREST);
  m_constants.endTransmittance = static_cast<float>(1 - preparation.parameters.number("termination_opacity"));
  // Entry i lies at scalar i/(size-1) and at table coordinate (i+0.5)/size.
  m_constants.tableScale = static_cast<float>(m_tableSize - 1) / static_cast<float>(m_tableSize);
  m_constants.tableBias = 0.5f / static_cast<float>(m_tableSize);
}

void VolumeMarcher::update(const Changes& changes, const FrameInputs& inputs, Recorder& recorder) {
  if (!changes.transferFunction) return;
  {
    const Pass pass = recorder.hostPass("build_transfer_function");
    m_table =
        (m_preintegrated ? preintegratedTable : postClassifiedTable)(*inputs.transferFunction, m_tableSize, m_step);
  }
  m_constants.visibleLow = m_table.visibleLow;
  m_constants.visibleHigh = m_table.visibleHigh;
  const Pass pass = recorder.pass("upload_transfer_function");
  recorder.gpu().upload(m_tableImage, std::as_bytes(std::span(m_table.entries)));
}

void VolumeMarcher::draw(const Frame& frame, std::uint64_t seed, std::span<const gpu::Resource> own,
                         Recorder& recorder) const {
  std::vector<gpu::Resource> resources = {gpu::SampledImage{m_tableImage.layerView(0), m_tableSampler.handle()}};
  resources.insert(resources.end(), own.begin(), own.end());
  m_marcher.march(frame, seed, m_constants, resources, recorder);
}

std::vector<ParameterDescriptor> emissionParameters() {
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

std::vector<PassDescriptor> emissionPasses() {
  return {{"build_transfer_function", "The table on the host, when the transfer function has changed."},
          {"upload_transfer_function", "The table to the GPU."},
          {"march", "All rays of all views."}};
}

std::vector<PassDescriptor> emissionGeneration() {
  return {{"upload", "The volume's voxels to the GPU."}, {"pipelines", "The timed and the counting pipeline."}};
}

std::vector<CounterDescriptor> emissionCounters() {
  std::vector<CounterDescriptor> counters =
      counterDescriptors("terminated_rays", "Rays that end before the exit because they are opaque.");
  counters.push_back({"visible_samples", CounterKind::perDevice, "Samples (slabs if pre-integrated) with opacity."});
  return counters;
}

std::vector<CounterValue> emissionCounterValues(const std::vector<std::uint64_t>& counts) {
  return {{"samples", counts[kCounterSamples]},
          {"rays", counts[kCounterRays]},
          {"terminated_rays", counts[kCounterEnded]},
          {"gradients", counts[kCounterGradients]},
          {"visible_samples", counts[kCounterVisible]}};
}

std::vector<ShadingModel> emissionShadings() {
  return {ShadingModel::none, ShadingModel::lambert, ShadingModel::phong, ShadingModel::gooch, ShadingModel::ggx};
}

std::optional<std::string> whyEmissionUnsupported(const Scene& scene, const ParameterValues& parameters,
                                                  const OutputSize& size, const gpu::Device* device) {
  if (asksForPreintegration(parameters) && !device->filtersLinearly(kTableFormat))
    return "The device can't filter the pre-integrated table (R32G32B32A32_SFLOAT) linearly.";
  return whyUnsupported(scene, parameters, size, device);
}

} // namespace volmark::parts
