#include "iso_octree.h"

#include "parts/marcher.h"
#include "parts/min_max_grid.h"
#include "parts/surface_raster.h"
#include "shared.h"
#include "volmark/gpu/target.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

namespace volmark::octree_isosurface {

namespace {

using namespace parts;

std::optional<int> skippedLevelsOf(const ParameterValues& parameters) {
  const auto levels = static_cast<int>(parameters.integer("initial_level"));
  return levels < 0 ? std::nullopt : std::optional(levels);
}

glm::ivec3 leafOf(const ParameterValues& parameters) {
  return glm::ivec3(static_cast<int>(parameters.integer("leaf")));
}

OctreeShape shapeOf(const ParameterValues& parameters, const Grid& grid) {
  return octreeShape(blocksOf(cellsOf(grid), leafOf(parameters)), skippedLevelsOf(parameters));
}

/// What a voxel beyond the leaf may add to a sample at its side: positions are good to 1e-4 voxel, in large volumes to
/// some units of the last place of a voxel coordinate.
float marginOf(const Volume& volume) {
  const double range =
      volume.type() == ScalarType::float32 ? volume.dataRange().maximum - volume.dataRange().minimum : 1.0;
  const glm::ivec3& dims = volume.grid().dims;
  const double voxel = std::max(1e-4, std::ldexp(std::max({dims.x, dims.y, dims.z}), -21));
  return static_cast<float>(voxel * range);
}

class IsoOctree final : public Technique {
public:
  void prepare(const Preparation& preparation, Recorder& recorder) override {
    const ParameterValues& parameters = preparation.parameters;
    const std::vector<gpu::MemoryItem> before = preparation.device->ledger().items();
    m_bisections = static_cast<std::uint32_t>(parameters.integer("bisections"));
    m_marcher.emplace(preparation, recorder);
    {
      const Pass pass = recorder.hostPass("pipelines");
      m_pipelines = m_marcher->makePipelines(
          preparation,
          {.shader = {.path = "octree_isosurface/iso_octree.glsl"},
           .variant = gpu::Specialisation().set(kIdBidirectional, parameters.text("traversal") == "bidirectional"),
           .own = {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
                   VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER},
           .isFragment = parameters.text("stage") == "fragment"});
      const Volume& volume = *preparation.scene.volume;
      const OctreeShape shape = shapeOf(parameters, volume.grid());
      m_octree.emplace(*preparation.device, volume, leafOf(parameters), shape, "octree");
      m_constants.blockShift = std::countr_zero(static_cast<unsigned>(parameters.integer("leaf")));
      m_constants.initialLevel = shape.initialLevel;
      m_constants.margin = marginOf(volume);
    }
    m_memory = memoryAdded(before, preparation.device->ledger().items());
    build(0, recorder);
  }

  void reset(std::uint64_t seed) override { m_seed = seed; }

  void update(const Changes&, const FrameInputs& inputs, Recorder& recorder) override {
    if (m_builtStep != inputs.timeStep) build(inputs.timeStep, recorder);
  }

  void draw(const Frame& frame, Recorder& recorder) override {
    const gpu::Resource own[] = {gpu::StorageImage{frame.target->normal.view()}, recorder.gpu().constants(m_constants),
                                 m_octree->nodes()};
    m_marcher->beginFrame(frame, recorder);
    m_marcher->march(m_pipelines, frame, m_seed, MarchConstants{.bisections = m_bisections}, own, recorder);
  }

  std::vector<CounterValue> counters() const override {
    const std::vector<std::uint64_t> counts = m_marcher->counts();
    return {{"samples", counts[kCounterSamples]},
            {"rays", counts[kCounterRays]},
            {"hits", counts[kCounterEnded]},
            {"gradients", counts[kCounterGradients]},
            {"node_tests", counts[kCounterNodes]}};
  }

  std::vector<gpu::MemoryItem> memory() const override { return m_memory; }

private:
  void build(int timeStep, Recorder& recorder) {
    const Pass pass = recorder.pass("build_octree");
    m_octree->build(recorder.gpu(), m_marcher->volume().at(timeStep));
    m_builtStep = timeStep;
  }

  std::optional<Marcher> m_marcher;
  std::optional<MinMaxGrid> m_octree;
  MarchPipelines m_pipelines;
  OctreeConstants m_constants{};
  std::optional<int> m_builtStep; ///< time step that the octree stands for
  std::uint32_t m_bisections = 0;
  std::uint64_t m_seed = 0;
  std::vector<gpu::MemoryItem> m_memory;
};

TechniqueInfo describe() {
  std::vector<CounterDescriptor> counters = counterDescriptors("hits", "Rays that meet the isosurface.");
  counters.push_back({"node_tests", CounterKind::perDevice, "Nodes of the octree that rays asked."});
  return {.name = "iso_octree",
          .summary = "Isosurface by marching rays that skip what a min-max octree knows to be outside.",
          .paper = "Kreskowski, Rendle, Froehlich: Efficient Direct Isosurface Rasterization of Scalar Volumes, 2022",
          .section = "4, \"min-max octree ray marching\"",
          .draws = Draws::isosurface,
          .maximumViews = gpu::kMaxViews,
          .shadings = surfaceShadings(),
          .parameters = {stepParameter(0.5),
                         ParameterDescriptor::integer("bisections", 3, 0, 16, "",
                                                      "Halvings of the interval that holds the crossing."),
                         ParameterDescriptor::oneOf("leaf", 8, {2, 4, 8, 16, 32, 64}, "cell", "Edge of the leaves."),
                         ParameterDescriptor::integer(
                             "initial_level", -1, -1, 30, "",
                             "Levels below the root that are never asked, 0 being none; -1: 3, or all but the leaves."),
                         ParameterDescriptor::choice(
                             "traversal", "bidirectional", {"bidirectional", "top_down"},
                             "Go on at the level of the last node, or start at the initial level every time."),
                         ParameterDescriptor::choice("stage", "compute", {"compute", "fragment"},
                                                     "Compute shader, or fragment shader over the whole picture."),
                         filteringParameter(), jitterParameter()},
          .passes = {{"build_octree", "All levels, when the time step has changed."},
                     {"march", "All rays of all views, shaded."}},
          .generation = {{"upload", "The volume's voxels to the GPU."},
                         {"pipelines", "The timed and the counting pipeline, the octree's memory."},
                         {"build_octree", "All levels from the volume."}},
          .counters = std::move(counters),
          .layers = {PictureLayer::normal, PictureLayer::steps}};
}

std::optional<std::string> whyOctreeUnsupported(const Scene& scene, const ParameterValues& parameters,
                                                const OutputSize& size, const gpu::Device* device) {
  if (auto why = whyUnsupported(scene, parameters, size, device)) return why;
  if (parameters.text("stage") == "fragment" && !device->facts().fragmentStores)
    return "The device can't write buffers in fragment shaders, which counts need; stage=compute can.";
  const Grid& grid = scene.volume->grid();
  const int rootLevel = rootLevelOf(blocksOf(cellsOf(grid), leafOf(parameters)));
  const std::optional<int> skipped = skippedLevelsOf(parameters);
  if (skipped && *skipped > rootLevel)
    return fmt::format("initial_level: found {}, allowed: at most {}, the level of the leaves of this octree.",
                       *skipped, rootLevel);
  return MinMaxGrid::whyUnsupported(*device, *scene.volume, shapeOf(parameters, grid));
}

} // namespace

TechniqueFactory isoOctree() {
  return {.info = describe(),
          .create = []() -> std::unique_ptr<Technique> { return std::make_unique<IsoOctree>(); },
          .whyUnsupported = whyOctreeUnsupported};
}

} // namespace volmark::octree_isosurface
