#include "skipping_technique.h"

#include "parts/volume_marcher.h"

#include <optional>

namespace volmark::empty_space_skipping {

namespace {

using Kind = StructureKind;

bool isOctree(Kind kind) {
  return kind == Kind::bitfieldOctree || kind == Kind::minMaxOctree || kind == Kind::booleanOctree;
}

int blockEdgeOf(Kind kind, const ParameterValues& parameters) {
  return static_cast<int>(parameters.integer(isOctree(kind) ? "leaf" : kind == Kind::bricks ? "brick" : "texel"));
}

StructureSettings settingsOf(Kind kind, const ParameterValues& parameters) {
  StructureSettings settings{.kind = kind, .blockEdge = blockEdgeOf(kind, parameters)};
  if (kind == Kind::bitfieldOctree) {
    settings.bits = static_cast<int>(parameters.integer("bits"));
    settings.voxelBlocks = parameters.text("support") == "voxels";
  }
  if (isOctree(kind) && parameters.integer("initial_level") >= 0)
    settings.skippedLevels = static_cast<int>(parameters.integer("initial_level"));
  return settings;
}

bool hasLabelOctree(Kind kind, const Volume& volume) {
  return kind == Kind::bitfieldOctree && volume.labels() != nullptr;
}

/// Of the octree of labels beside another one: the same blocks and levels.
StructureSettings labelSettings(StructureSettings settings) {
  settings.kind = Kind::labelOctree;
  return settings;
}

class SkippingTechnique final : public Technique {
public:
  explicit SkippingTechnique(Kind kind) : m_kind(kind) {}

  void prepare(const Preparation& preparation, Recorder& recorder) override;
  void reset(std::uint64_t seed) override { m_seed = seed; }
  void update(const Changes& changes, const FrameInputs& inputs, Recorder& recorder) override;
  void draw(const Frame& frame, Recorder& recorder) override;
  std::vector<CounterValue> counters() const override;
  std::vector<gpu::MemoryItem> memory() const override { return m_memory; }

private:
  void build(int timeStep, Recorder& recorder);

  Kind m_kind;
  std::optional<parts::VolumeMarcher> m_marcher;
  std::unique_ptr<Structure> m_structure;
  std::unique_ptr<Structure> m_labelOctree; ///< bitfield octree, of volumes with labels
  VisibleScalars m_visible;                 ///< on either side of the clipping planes
  SkippingConstants m_constants{};
  std::optional<int> m_builtStep; ///< time step that the structure stands for
  std::uint64_t m_seed = 0;
  std::vector<gpu::MemoryItem> m_memory;
};

void SkippingTechnique::prepare(const Preparation& preparation, Recorder& recorder) {
  const ParameterValues& parameters = preparation.parameters;
  const StructureSettings settings = settingsOf(m_kind, parameters);
  const std::vector<gpu::MemoryItem> before = preparation.device->ledger().items();

  parts::VolumeMarcherDescription description{.shader = "empty_space_skipping/dvr_skipping.comp.glsl",
                                              .macros = {{macroOf(m_kind), "1"}},
                                              .own = {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER}};
  const std::vector<VkDescriptorType> bindings = structureBindings(m_kind);
  description.own.insert(description.own.end(), bindings.begin(), bindings.end());
  description.variant.set(kIdBidirectional, isOctree(m_kind) && parameters.text("traversal") == "bidirectional")
      .set(kIdVoxelBlocks, settings.voxelBlocks)
      // A step is in voxels of the smallest spacing: it is as long at most along any axis, so that samples next to each
      // other lie in one block or in two that touch.
      .set(kIdSharedSlabs, parameters.number("step") <= settings.blockEdge);
  const bool asksLabels = hasLabelOctree(m_kind, *preparation.scene.volume);
  if (asksLabels) {
    const std::size_t binding = kBindingSkipping + description.own.size();
    description.macros.emplace_back("LABEL_OCTREE_BINDING", std::to_string(binding));
    description.own.push_back(VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER);
  }
  m_marcher.emplace(preparation, description, recorder);
  {
    const Pass pass = recorder.hostPass("structure_pipelines");
    m_structure = makeStructure(*preparation.device, preparation.scene, m_marcher->volume(), settings);
    if (asksLabels)
      m_labelOctree = makeStructure(*preparation.device, parts::sceneOfLabels(preparation.scene), *m_marcher->labels(),
                                    labelSettings(settings));
  }
  m_memory = parts::memoryAdded(before, preparation.device->ledger().items());
  if (!m_structure->dependsOnTransferFunction()) build(0, recorder);
  if (m_labelOctree) {
    const Pass pass = recorder.pass("build_label_octree");
    m_labelOctree->build(recorder.gpu(), m_marcher->labels()->at(0), m_visible);
  }
}

void SkippingTechnique::build(int timeStep, Recorder& recorder) {
  if (m_kind == Kind::bricks) {
    const Pass pass = recorder.hostPass("choose_bricks");
    m_structure->prepareBuild(timeStep, m_visible);
  }
  const Pass pass = recorder.pass("build_structure");
  m_structure->build(recorder.gpu(), m_marcher->volume().at(timeStep), m_visible);
  m_builtStep = timeStep;
}

void SkippingTechnique::update(const Changes& changes, const FrameInputs& inputs, Recorder& recorder) {
  m_marcher->update(changes, inputs, recorder);
  if (changes.transferFunction) {
    const Pass pass = recorder.hostPass("build_mask");
    const VisibleScalars kept(m_marcher->table());
    const parts::TransferTable* other = m_marcher->tableBeyond();
    const VisibleScalars beyond = other ? VisibleScalars(*other) : kept;
    m_visible = other ? kept.either(beyond) : kept;
    m_constants = m_structure->constants(kept, beyond);
  }
  const bool outdated = changes.transferFunction && m_structure->dependsOnTransferFunction();
  if (outdated || m_builtStep != inputs.timeStep) build(inputs.timeStep, recorder);
}

void SkippingTechnique::draw(const Frame& frame, Recorder& recorder) {
  SkippingConstants constants = m_constants;
  constants.shown = ~parts::bitsOf(frame.inputs.hiddenSegments);
  std::vector<gpu::Resource> resources = {recorder.gpu().constants(constants)};
  for (const gpu::Resource& resource : m_structure->resources())
    resources.push_back(resource);
  if (m_labelOctree) resources.push_back(m_labelOctree->resources().front());
  m_marcher->draw(frame, m_seed, resources, recorder);
}

std::vector<CounterValue> SkippingTechnique::counters() const {
  const std::vector<std::uint64_t> counts = m_marcher->counts();
  std::vector<CounterValue> values = parts::emissionCounterValues(counts);
  values.push_back({"node_tests", counts[parts::kCounterNodes]});
  values.push_back({"shadow_node_tests", counts[parts::kCounterShadowNodes]});
  return values;
}

// --- Descriptions --------------------------------------------------------------------------------------------

std::vector<ParameterDescriptor> parametersOf(Kind kind) {
  std::vector<ParameterDescriptor> parameters = parts::emissionParameters();
  const std::vector<std::int64_t> edges = {2, 4, 8, 16, 32, 64};
  if (kind == Kind::bricks) {
    parameters.push_back(ParameterDescriptor::oneOf("brick", 8, edges, "voxel", "Edge of the bricks."));
    return parameters;
  }
  if (!isOctree(kind)) {
    parameters.push_back(ParameterDescriptor::oneOf(
        "texel", 4, edges, "voxel", "Edge of the map's texels; 4 is a quarter of the volume's resolution."));
    return parameters;
  }
  parameters.push_back(ParameterDescriptor::oneOf("leaf", 4, edges, "voxel", "Edge of the leaves."));
  parameters.push_back(ParameterDescriptor::integer(
      "initial_level", -1, -1, 30, "",
      "Levels below the root that are never asked, 0 being none; -1: 3, or all but the leaves where there are fewer."));
  parameters.push_back(
      ParameterDescriptor::choice("traversal", "bidirectional", {"bidirectional", "top_down"},
                                  "Go on at the level of the last node, or start at the initial level every time."));
  if (kind == Kind::bitfieldOctree) {
    parameters.push_back(ParameterDescriptor::oneOf("bits", 32, {8, 16, 32, 64, 128}, "",
                                                    "Width of a node's bitfield, and of the transfer function's."));
    parameters.push_back(ParameterDescriptor::choice("support", "cells", {"cells", "voxels"},
                                                     "Bins of all trilinear values in a block, or of its voxels alone: "
                                                     "the paper's, which may skip what lies between."));
  }
  return parameters;
}

std::vector<PassDescriptor> passesOf(Kind kind) {
  std::vector<PassDescriptor> passes = parts::emissionPasses();
  passes.push_back({"build_mask", "What the transfer function shows, on the host, when it has changed."});
  if (kind == Kind::bricks)
    passes.push_back({"choose_bricks", "Bricks that show, on the host, before the structure is built."});
  passes.push_back(
      {"build_structure", kind == Kind::bitfieldOctree || kind == Kind::minMaxOctree
                              ? "The octree, when the time step has changed."
                              : "The structure, when the transfer function or the time step has changed."});
  return passes;
}

std::vector<PassDescriptor> generationOf(Kind kind) {
  std::vector<PassDescriptor> passes = parts::emissionGeneration();
  passes.push_back({"structure_pipelines", "Pipelines and memory of the structure."});
  if (kind == Kind::bitfieldOctree || kind == Kind::minMaxOctree)
    passes.push_back({"build_structure", "The octree from the volume."});
  if (kind == Kind::bitfieldOctree)
    passes.push_back({"build_label_octree", "The octree of labels, of scenes with them."});
  return passes;
}

TechniqueInfo describe(Kind kind, const char* name, const char* summary, const char* section) {
  std::vector<CounterDescriptor> counters = parts::emissionCounters();
  counters.push_back({"node_tests", CounterKind::perDevice,
                      isOctree(kind)         ? "Nodes of the octree that rays asked."
                      : kind == Kind::bricks ? "Ray queries; boxes that one meets are not counted."
                                             : "Texels of the map that rays asked."});
  counters.push_back({"shadow_node_tests", CounterKind::perDevice, "The same of rays of the light."});
  return {.name = name,
          .summary = summary,
          .paper = "Faludi, Zentai, Zelechowski, Zam, Rauter, Griessen, Cattin: Transfer-Function-Independent "
                   "Acceleration Structure for Volume Rendering in Virtual Reality, 2021",
          .section = section,
          .draws = Draws::volume,
          .maximumViews = gpu::kMaxViews,
          .shadings = parts::emissionShadings(),
          .shadows = true,
          .functionBeyond = true,
          .segments = true,
          .parameters = parametersOf(kind),
          .passes = passesOf(kind),
          .generation = generationOf(kind),
          .counters = std::move(counters),
          .layers = {PictureLayer::steps}};
}

template <Kind kind> std::unique_ptr<Technique> create() {
  return std::make_unique<SkippingTechnique>(kind);
}

template <Kind kind>
std::optional<std::string> whyUnsupported(const Scene& scene, const ParameterValues& parameters, const OutputSize& size,
                                          const gpu::Device* device) {
  if (auto why = parts::whyEmissionUnsupported(scene, parameters, size, device)) return why;
  const StructureSettings settings = settingsOf(kind, parameters);
  if (auto why = whyStructureUnsupported(settings, *scene.volume, *device)) return why;
  if (!hasLabelOctree(kind, *scene.volume)) return std::nullopt;
  return whyStructureUnsupported(labelSettings(settings), *scene.volume->labels(), *device);
}

template <Kind kind> TechniqueFactory factory(const char* name, const char* summary, const char* section) {
  return {
      .info = describe(kind, name, summary, section), .create = create<kind>, .whyUnsupported = whyUnsupported<kind>};
}

} // namespace

TechniqueFactory dvrBitfieldOctree() {
  return factory<Kind::bitfieldOctree>(
      "dvr_bitfield_octree", "Skips nodes of an octree whose bins of scalars the transfer function does not show.",
      "3 (the technique of the paper); column \"Bitfield Octree\" of table 1");
}

TechniqueFactory dvrMinMaxOctree() {
  return factory<Kind::minMaxOctree>(
      "dvr_minmax_octree", "Skips nodes of an octree whose range of scalars lies outside of all that is visible.",
      "4.4, column \"Min-Max Octree\" of table 1");
}

TechniqueFactory dvrBooleanOctree() {
  return factory<Kind::booleanOctree>("dvr_boolean_octree",
                                      "Skips nodes of an octree that is built anew for each transfer function.",
                                      "4.4, column \"Boolean Octree\" of table 1");
}

TechniqueFactory dvrDistanceMap() {
  return factory<Kind::distanceMap>("dvr_distance_map",
                                    "Leaps by the Euclidean distance to what the transfer function shows.",
                                    "4.4, column \"Distance Map\" of table 1");
}

TechniqueFactory dvrRayQuery() {
  return factory<Kind::bricks>("dvr_ray_query", "Asks the device's ray queries for the next brick that is visible.",
                               "none: beyond the paper; hardware traversal of boxes");
}

TechniqueFactory dvrChebyshevDistance() {
  return factory<Kind::chebyshevMap>("dvr_chebyshev_distance",
                                     "Leaps through empty cubes ahead of the ray, stored for each of eight octants.",
                                     "none: beyond the paper; Es and Isler 2007, which it cites");
}

} // namespace volmark::empty_space_skipping
