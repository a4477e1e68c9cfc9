#include "parts/volume_marcher.h"

namespace volmark::parts {

namespace {

constexpr VkFormat kTableFormat = VK_FORMAT_R32G32B32A32_SFLOAT;

bool asksForPreintegration(const ParameterValues& parameters) {
  return parameters.text("transfer_function_kind") == "preintegrated";
}

} // namespace

Scene sceneOfLabels(const Scene& scene) {
  return {.name = scene.name, .volume = scene.volume->labels(), .visualisationRange = {0, 255}};
}

uvec4 bitsOf(const std::bitset<kMaximumSegments>& segments) {
  uvec4 bits(0);
  for (std::size_t i = 0; i < segments.size(); ++i)
    if (segments[i]) bits[static_cast<int>(i / 32)] |= 1u << (i % 32);
  return bits;
}

void VolumeMarcher::makePipelines(const Preparation& preparation, const VolumeMarcherDescription& description) {
  MarcherDescription common{.shader = {.path = description.shader, .macros = description.macros},
                            .variant = description.variant,
                            .own = {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER}};
  if (m_preintegrated) common.shader.macros.emplace_back("PREINTEGRATED", "1");
  common.variant.set(kIdEarlyTermination, preparation.parameters.boolean("early_termination"));
  common.own.insert(common.own.end(), description.own.begin(), description.own.end());
  const auto bind = [](MarcherDescription& one, const char* macro, VkDescriptorType type) {
    one.shader.macros.emplace_back(macro, std::to_string(kBindingOwn + static_cast<int>(one.own.size())));
    one.own.push_back(type);
  };
  if (m_labels) bind(common, "LABELS_BINDING", VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER);
  if (m_beyond) bind(common, "BEYOND_BINDING", VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER);
  MarcherDescription picture = common;
  if (m_shadows) {
    bind(common, "SHADOW_MAP_BINDING", VK_DESCRIPTOR_TYPE_STORAGE_IMAGE);
    m_shadowPipelines = m_marcher.makePipelines(preparation, common);
    bind(picture, "SHADOWS_BINDING", VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER);
  }
  m_pipelines = m_marcher.makePipelines(preparation, picture);
}

VolumeMarcher::VolumeMarcher(const Preparation& preparation, const VolumeMarcherDescription& description,
                             Recorder& recorder)
    : m_step(preparation.parameters.number("step")), m_preintegrated(asksForPreintegration(preparation.parameters)),
      m_tableSize(
          static_cast<int>(preparation.parameters.integer(m_preintegrated ? "preintegrated_size" : "table_size"))),
      m_shadowBias(preparation.parameters.number("shadow_bias")), m_marcher(preparation, recorder),
      m_scene(&preparation.scene), m_kept(makeTable(*preparation.device, "transfer_function")) {
  const Scene& scene = preparation.scene;
  if (scene.volume->labels()) {
    // Texels are fetched: nothing is filtered.
    m_labels.emplace(*preparation.device, sceneOfLabels(scene), gpu::Filtering::shader, recorder);
  }
  if (scene.functionBeyond) m_beyond = makeTable(*preparation.device, "transfer_function_beyond");
  // Unshaded colours need no light.
  if (scene.shading.shadows && scene.shading.model != ShadingModel::none)
    m_shadows.emplace(*preparation.device, static_cast<int>(preparation.parameters.integer("shadow_resolution")));
  m_tableSampler = gpu::Sampler(*preparation.device, m_preintegrated ? VK_FILTER_LINEAR : VK_FILTER_NEAREST);
  {
    const Pass pass = recorder.hostPass("pipelines");
    makePipelines(preparation, description);
  }
  m_constants.endTransmittance = static_cast<float>(1 - preparation.parameters.number("termination_opacity"));
  // Entry i lies at scalar i/(size-1) and at table coordinate (i+0.5)/size.
  m_constants.tableScale = static_cast<float>(m_tableSize - 1) / static_cast<float>(m_tableSize);
  m_constants.tableBias = 0.5f / static_cast<float>(m_tableSize);
}

TableOnGpu VolumeMarcher::makeTable(gpu::Device& device, const char* name) const {
  const auto size = static_cast<std::uint32_t>(m_tableSize);
  return {.image = gpu::Image(device, {.name = name,
                                       .type = m_preintegrated ? VK_IMAGE_TYPE_2D : VK_IMAGE_TYPE_1D,
                                       .format = kTableFormat,
                                       .extent = {size, m_preintegrated ? size : 1, 1},
                                       .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT})};
}

void VolumeMarcher::fill(TableOnGpu& table, const TransferFunction& function, Recorder& recorder) const {
  {
    const Pass pass = recorder.hostPass("build_transfer_function");
    table.table = (m_preintegrated ? preintegratedTable : postClassifiedTable)(function, m_tableSize, m_step);
  }
  const Pass pass = recorder.pass("upload_transfer_function");
  recorder.gpu().upload(table.image, std::as_bytes(std::span(table.table.entries)));
}

void VolumeMarcher::update(const Changes& changes, const FrameInputs& inputs, Recorder& recorder) {
  // The other function belongs to the scene.
  if (m_beyond && m_beyond->table.entries.empty()) {
    fill(*m_beyond, *m_scene->functionBeyond, recorder);
    m_constants.visibleLowBeyond = m_beyond->table.visibleLow;
    m_constants.visibleHighBeyond = m_beyond->table.visibleHigh;
  }
  if (!changes.transferFunction) return;
  fill(m_kept, *inputs.transferFunction, recorder);
  m_constants.visibleLow = m_kept.table.visibleLow;
  m_constants.visibleHigh = m_kept.table.visibleHigh;
}

void VolumeMarcher::drawShadowMap(const Frame& frame, std::vector<gpu::Resource> resources,
                                  const MarchConstants& constants, Recorder& recorder) const {
  resources.emplace_back(m_shadows->written());
  m_shadows->beginWriting(recorder.gpu());
  m_marcher.marchFromLight(m_shadowPipelines, frame, constants, resources, recorder);
  m_shadows->endWriting(recorder.gpu());
}

void VolumeMarcher::draw(const Frame& frame, std::uint64_t seed, std::span<const gpu::Resource> own,
                         Recorder& recorder) const {
  const auto tableOf = [&](const TableOnGpu& table) {
    return gpu::SampledImage{table.image.layerView(0), m_tableSampler.handle()};
  };
  std::vector<gpu::Resource> resources = {tableOf(m_kept)};
  resources.insert(resources.end(), own.begin(), own.end());
  if (m_labels) resources.emplace_back(m_labels->at(0));
  if (m_beyond) resources.emplace_back(tableOf(*m_beyond));
  m_marcher.beginFrame(frame, recorder);
  MarchConstants constants = m_constants;
  constants.hidden = bitsOf(frame.inputs.hiddenSegments);
  if (m_shadows) {
    m_shadows->describe(frame.inputs.light, m_scene->volume->grid(), m_shadowBias, constants);
    drawShadowMap(frame, resources, constants, recorder);
    resources.emplace_back(m_shadows->read());
  }
  m_marcher.march(m_pipelines, frame, seed, constants, resources, recorder);
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
          jitterParameter(),
          ParameterDescriptor::integer("shadow_resolution", 1024, 16, 8192, "texel",
                                       "Side of the shadow map, of scenes with shadows; marched in every frame."),
          ParameterDescriptor::number("shadow_bias", 1, 0, 16, "voxel",
                                      "Samples nearer to what shades them than this are lit.")};
}

std::vector<PassDescriptor> emissionPasses() {
  return {{"build_transfer_function", "The table on the host, when the transfer function has changed."},
          {"upload_transfer_function", "The table to the GPU."},
          {"shadow_map", "All rays of the light, of scenes with shadows."},
          {"march", "All rays of all views."}};
}

std::vector<PassDescriptor> emissionGeneration() {
  return {{"upload", "The volume's voxels to the GPU."}, {"pipelines", "The timed and the counting pipelines."}};
}

std::vector<CounterDescriptor> emissionCounters() {
  std::vector<CounterDescriptor> counters =
      counterDescriptors("terminated_rays", "Rays that end before the exit because they are opaque.");
  counters.push_back({"visible_samples", CounterKind::perDevice, "Samples (slabs if pre-integrated) with opacity."});
  counters.push_back({"shadow_samples", CounterKind::perDevice, "Samples along rays of the light."});
  return counters;
}

std::vector<CounterValue> emissionCounterValues(const std::vector<std::uint64_t>& counts) {
  return {{"samples", counts[kCounterSamples]},         {"rays", counts[kCounterRays]},
          {"terminated_rays", counts[kCounterEnded]},   {"gradients", counts[kCounterGradients]},
          {"visible_samples", counts[kCounterVisible]}, {"shadow_samples", counts[kCounterShadowSamples]}};
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
