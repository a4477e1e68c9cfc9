#include "mesh_shader_isosurface.h"

#include "block_grid.h"
#include "chosen_blocks.h"
#include "parts/marcher.h"
#include "visible_regions.h"
#include "volmark/gpu/target.h"

#include <fmt/format.h>

#include <optional>

namespace volmark::direct_rasterization {

namespace {

constexpr VkDescriptorType kDrawBindings[] = {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                              VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};

/// The most triangles that so many vertices of cells can make: five of seven
/// (parts/tests/marching_cubes_table_test.cpp).
std::int64_t triangleLimit(std::int64_t vertices) {
  return vertices * 5 / 7;
}

class MeshShaderIsosurface final : public Technique {
public:
  void prepare(const Preparation& preparation, Recorder& recorder) override;
  void reset(std::uint64_t seed) override;
  void update(const Changes& changes, const FrameInputs& inputs, Recorder& recorder) override;
  void draw(const Frame& frame, Recorder& recorder) override;
  std::vector<CounterValue> counters() const override;
  std::vector<gpu::MemoryItem> memory() const override { return m_memory; }

private:
  void buildRanges(int timeStep, Recorder& recorder);
  ChoiceInputs choiceInputs() const;
  void drawBlocks(const Frame& frame, const parts::Compaction& list, bool first, Recorder& recorder);
  void drawAll(const Frame& frame, Recorder& recorder);
  void drawVisible(const Frame& frame, Recorder& recorder);

  std::optional<parts::SurfaceRaster> m_raster;
  std::optional<parts::MinMaxGrid> m_ranges;
  std::optional<int> m_builtStep; ///< time step that the ranges stand for
  BlockConstants m_constants{};
  gpu::BufferRange m_blocks;                   ///< the constants, in this frame
  std::optional<parts::Compaction> m_occupied; ///< without culling: all blocks that are drawn
  std::optional<parts::Compaction> m_previous; ///< with it: those of the first pass,
  std::optional<parts::Compaction> m_new;      ///< and of the last one
  std::optional<VisibleRegions> m_regions;
  gpu::Buffer m_noFlags; ///< without culling: what the choosing shader is bound to instead
  parts::SurfacePipelines m_extract;
  std::uint64_t m_seed = 0;
  std::vector<gpu::MemoryItem> m_memory;
};

void MeshShaderIsosurface::prepare(const Preparation& preparation, Recorder& recorder) {
  gpu::Device& device = *preparation.device;
  const Volume& volume = *preparation.scene.volume;
  const ParameterValues& parameters = preparation.parameters;
  const std::vector<gpu::MemoryItem> before = device.ledger().items();
  m_raster.emplace(preparation, kCounters, recorder);
  {
    const Pass pass = recorder.hostPass("pipelines");
    const BlockSettings settings = blockSettings(parameters);
    m_constants = blockConstants(settings, volume.grid(), device);
    m_ranges.emplace(device, volume, settings.cells, "block_ranges");
    const std::uint32_t blocks = parts::countOf(m_constants.blocks);
    if (parameters.boolean("culling")) {
      m_previous.emplace(makeBlockList(device, *m_raster, "previous_blocks", Choice::previous, blocks));
      m_new.emplace(makeBlockList(device, *m_raster, "new_blocks", Choice::newlyVisible, blocks));
      m_regions.emplace(device, *m_raster, parts::countOf(m_constants.regions), preparation.size.views);
    } else {
      m_occupied.emplace(makeBlockList(device, *m_raster, "blocks", Choice::occupied, blocks));
      m_noFlags = gpu::Buffer(device, {"no_flags", sizeof(uint), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT});
    }
    const std::int64_t vertices = parameters.integer("vertex_limit");
    const std::vector<std::pair<std::string, std::string>> macros = {
        {"VERTEX_LIMIT", std::to_string(vertices)}, {"TRIANGLE_LIMIT", std::to_string(triangleLimit(vertices))}};
    gpu::Specialisation variant;
    variant.set(kIdBlockX, settings.cells.x).set(kIdBlockY, settings.cells.y).set(kIdBlockZ, settings.cells.z);
    m_extract =
        m_raster->makePipelines("extract",
                                {{"direct_rasterization/extract.task.glsl", VK_SHADER_STAGE_TASK_BIT_EXT, macros},
                                 {"direct_rasterization/extract.mesh.glsl", VK_SHADER_STAGE_MESH_BIT_EXT, macros}},
                                kDrawBindings, sizeof(DrawConstants), variant);
  }
  m_memory = parts::memoryAdded(before, device.ledger().items());
  buildRanges(0, recorder);
}

void MeshShaderIsosurface::reset(std::uint64_t seed) {
  m_seed = seed;
  if (m_regions) m_regions->reset();
}

void MeshShaderIsosurface::buildRanges(int timeStep, Recorder& recorder) {
  const Pass pass = recorder.pass("build_ranges");
  m_ranges->build(recorder.gpu(), m_raster->voxels(timeStep));
  m_builtStep = timeStep;
}

void MeshShaderIsosurface::update(const Changes&, const FrameInputs& inputs, Recorder& recorder) {
  if (m_builtStep != inputs.timeStep) buildRanges(inputs.timeStep, recorder);
}

ChoiceInputs MeshShaderIsosurface::choiceInputs() const {
  return {.blocks = m_blocks,
          .ranges = m_ranges->nodes(),
          .previous = m_regions ? m_regions->previous() : m_noFlags.range(),
          .visible = m_regions ? m_regions->visible() : m_noFlags.range()};
}

void MeshShaderIsosurface::drawBlocks(const Frame& frame, const parts::Compaction& list, bool first,
                                      Recorder& recorder) {
  gpu::Commands& commands = recorder.gpu();
  commands.barrier(gpu::kDrawWrite, gpu::kDrawWrite);
  const gpu::Rendering rendering(commands, m_raster->rendering(frame, first));
  if (first) m_raster->drawCaps(frame, recorder);
  drawList(commands, parts::SurfaceRaster::choose(m_extract, frame), *m_raster, list, m_blocks, {},
           chunkOf(commands.device()));
}

void MeshShaderIsosurface::drawAll(const Frame& frame, Recorder& recorder) {
  {
    const Pass pass = recorder.pass("choose_blocks");
    record(*m_occupied, recorder.gpu(), *m_raster, choiceInputs(), frame.counting);
  }
  const Pass pass = recorder.pass("draw_blocks");
  drawBlocks(frame, *m_occupied, true, recorder);
}

// Figure 2 of the paper.
void MeshShaderIsosurface::drawVisible(const Frame& frame, Recorder& recorder) {
  gpu::Commands& commands = recorder.gpu();
  {
    const Pass pass = recorder.pass("choose_previous");
    m_regions->beginFrame(commands);
    record(*m_previous, commands, *m_raster, choiceInputs(), frame.counting);
    m_regions->choose(commands, *m_raster, choiceInputs(), frame.counting);
  }
  {
    const Pass pass = recorder.pass("draw_previous");
    drawBlocks(frame, *m_previous, true, recorder);
  }
  {
    const Pass pass = recorder.pass("draw_proxies");
    m_regions->drawProxies(frame, commands, *m_raster, m_blocks);
  }
  {
    const Pass pass = recorder.pass("choose_new");
    record(*m_new, commands, *m_raster, choiceInputs(), frame.counting);
  }
  const Pass pass = recorder.pass("draw_new");
  drawBlocks(frame, *m_new, false, recorder);
}

void MeshShaderIsosurface::draw(const Frame& frame, Recorder& recorder) {
  m_raster->beginFrame(frame, m_seed, recorder);
  m_blocks = recorder.gpu().constants(m_constants);
  if (m_regions)
    drawVisible(frame, recorder);
  else
    drawAll(frame, recorder);
  if (frame.counting)
    recorder.gpu().barrier({VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_SHADER_WRITE_BIT}, gpu::kHostRead);
}

// --- Descriptions --------------------------------------------------------------------------------------------

std::vector<CounterDescriptor> counterDescriptors() {
  return {{"occupied_regions", CounterKind::exact, "Regions that the surface goes through; 0 without culling."},
          {"blocks", CounterKind::perDevice, "Blocks drawn: a task workgroup each."},
          {"cells", CounterKind::perDevice, "Occupied cells of these blocks."},
          {"vertices", CounterKind::perDevice, "Of all lists; a view more costs none."},
          {"triangles", CounterKind::perDevice, "Of all lists."},
          {"lists", CounterKind::perDevice, "Lists of cells: a mesh workgroup each."},
          {"proxies", CounterKind::perDevice, "Regions whose proxy was drawn."}};
}

std::vector<CounterValue> valuesOf(const std::vector<std::uint64_t>& counts) {
  std::vector<CounterValue> values;
  const std::vector<CounterDescriptor> descriptors = counterDescriptors();
  for (std::size_t i = 0; i < descriptors.size(); ++i)
    values.push_back({descriptors[i].name, counts[i]});
  return values;
}

TechniqueInfo describe() {
  return {.name = "mesh_shader_isosurface",
          .summary = "Isosurface extracted by task and mesh shaders in every frame, with occlusion culling of regions.",
          .paper = "Kreskowski, Rendle, Froehlich: Efficient Direct Isosurface Rasterization of Scalar Volumes, 2022",
          .section = "3 (the technique of the paper)",
          .draws = Draws::isosurface,
          .history = History::lossless,
          .maximumViews = gpu::kMaxViews,
          .shadings = parts::surfaceShadings(),
          .parameters = {ParameterDescriptor::boolean("culling", true,
                                                      "Draw only blocks of regions that something may be seen of."),
                         ParameterDescriptor::choice("granularity", "8x8x8", {"block", "8x8x8", "16x16x16", "32x32x32"},
                                                     "Cells of a region, for culling."),
                         ParameterDescriptor::oneOf("vertex_limit", 96, {32, 48, 64, 96, 128, 192, 256}, "vertex",
                                                    "Of a list of cells: what a mesh workgroup extracts for a view."),
                         ParameterDescriptor::choice("block", "8x8x4", {"8x8x4", "16x4x4", "8x4x4", "4x4x4"},
                                                     "Cells of a block: what a task workgroup classifies.")},
          .passes = {{"build_ranges", "Smallest and largest voxel of each block, when the time step has changed."},
                     {"choose_blocks", "Occupied blocks, without culling."},
                     {"draw_blocks", "All of them, without culling."},
                     {"choose_previous", "Occupied blocks that were visible in the last frame, and occupied regions."},
                     {"draw_previous", "These blocks."},
                     {"draw_proxies", "A quad for each occupied region and view: what is visible in this frame."},
                     {"choose_new", "Blocks that have become visible."},
                     {"draw_new", "These blocks."}},
          .generation = {{"upload", "The volume's voxels to the GPU."},
                         {"upload_table", "The table of marching cubes."},
                         {"pipelines", "Pipelines and buffers."},
                         {"build_ranges", "Smallest and largest voxel of each block."}},
          .counters = counterDescriptors(),
          .layers = {PictureLayer::normal}};
}

std::optional<std::string> whyUnsupported(const Scene& scene, const ParameterValues& parameters, const OutputSize& size,
                                          const gpu::Device* device) {
  const gpu::DeviceFacts& facts = device->facts();
  if (!facts.meshShader) return fmt::format("The device {} has no mesh shaders.", facts.name);
  if (!facts.int8) return fmt::format("The device {} has no 8-bit integers, which payloads are made of.", facts.name);
  if (!facts.fragmentStores) return fmt::format("The device {} can't write buffers in fragment shaders.", facts.name);
  if (auto why = parts::whySurfaceUnsupported(scene, device)) return why;
  if (auto why = whySettingsUnsupported(parameters)) return why;
  const std::int64_t vertices = parameters.integer("vertex_limit");
  if (vertices * size.views > facts.maximumMeshVertices ||
      triangleLimit(vertices) * size.views > facts.maximumMeshPrimitives)
    return fmt::format("vertex_limit: {} vertices and {} triangles for each of {} views, allowed by the device: {} and "
                       "{} for all views.",
                       vertices, triangleLimit(vertices), size.views, facts.maximumMeshVertices,
                       facts.maximumMeshPrimitives);
  if (parameters.boolean("culling") &&
      4u * kTaskThreads * static_cast<unsigned>(size.views) > facts.maximumMeshVertices)
    return fmt::format("culling: proxies for {} views need {} vertices, allowed by the device: {}.", size.views,
                       4 * kTaskThreads * size.views, facts.maximumMeshVertices);
  const Grid& grid = scene.volume->grid();
  const glm::ivec3 blocks = parts::blocksOf(parts::cellsOf(grid), blockSettings(parameters).cells);
  const std::uint64_t bytes = std::uint64_t(parts::countOf(blocks)) * sizeof(uint);
  if (bytes > facts.maximumStorageBufferRange)
    return fmt::format("A list of {} blocks needs {} bytes, the device's storage buffers hold {}.",
                       parts::countOf(blocks), bytes, facts.maximumStorageBufferRange);
  return parts::MinMaxGrid::whyUnsupported(*device, *scene.volume,
                                           parts::octreeShape(blocks, parts::rootLevelOf(blocks)));
}

std::vector<CounterValue> MeshShaderIsosurface::counters() const {
  return valuesOf(m_raster->counts());
}

} // namespace

TechniqueFactory meshShaderIsosurface() {
  return {.info = describe(),
          .create = []() -> std::unique_ptr<Technique> { return std::make_unique<MeshShaderIsosurface>(); },
          .whyUnsupported = whyUnsupported};
}

} // namespace volmark::direct_rasterization
