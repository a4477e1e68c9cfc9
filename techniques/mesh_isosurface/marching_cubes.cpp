#include "marching_cubes.h"

#include "extracted_surface.h"
#include "parts/marcher.h"

namespace volmark::mesh_isosurface {

namespace {

class MarchingCubes final : public Technique {
public:
  void prepare(const Preparation& preparation, Recorder& recorder) override {
    m_device = preparation.device;
    const std::vector<gpu::MemoryItem> before = m_device->ledger().items();
    m_surface.emplace(preparation, recorder);
    {
      const Pass pass = recorder.hostPass("pipelines");
      m_draw.emplace(m_surface->raster(), preparation.parameters.boolean("depth_prepass"));
    }
    m_prepared = parts::memoryAdded(before, m_device->ledger().items());
  }

  void reset(std::uint64_t seed) override { m_seed = seed; }

  void update(const Changes&, const FrameInputs& inputs, Recorder& recorder) override {
    m_surface->update(inputs, recorder);
  }

  void draw(const Frame& frame, Recorder& recorder) override {
    m_surface->raster().beginFrame(frame, m_seed, recorder);
    m_draw->draw(frame, m_surface->raster(), m_surface->extractor().mesh(), recorder);
  }

  std::vector<CounterValue> counters() const override {
    const IndexedMesh mesh = m_surface->extractor().mesh();
    return {{"vertices", mesh.vertexCount}, {"triangles", mesh.triangleCount}};
  }

  std::optional<SurfaceMesh> surface() const override { return readBack(*m_device, m_surface->extractor().mesh()); }

  std::vector<gpu::MemoryItem> memory() const override { return memoryNow(m_prepared, m_surface->extractor()); }

private:
  gpu::Device* m_device = nullptr;
  std::optional<ExtractedSurface> m_surface;
  std::optional<IndexedDraw> m_draw;
  std::uint64_t m_seed = 0;
  std::vector<gpu::MemoryItem> m_prepared;
};

TechniqueInfo describe() {
  std::vector<PassDescriptor> passes = extractionPasses();
  passes.push_back({"depth_prepass", "Depth of the mesh alone, if asked for."});
  passes.push_back({"draw_mesh", "The mesh, shaded."});
  return {.name = "marching_cubes",
          .summary = "Isosurface extracted to a mesh on the GPU when it changes, drawn by the vertex pipeline.",
          .paper = "Lorensen, Cline: Marching Cubes: A High Resolution 3D Surface Construction Algorithm, 1987",
          .section = "as \"MC\" of Nysjö, Malmberg, Nyström: RayCaching, 2019, section 4",
          .draws = Draws::isosurface,
          .maximumViews = gpu::kMaxViews,
          .shadings = parts::surfaceShadings(),
          .parameters = {ParameterDescriptor::boolean("depth_prepass", false,
                                                      "Draw depth alone first, so that no hidden fragment is shaded.")},
          .passes = std::move(passes),
          .generation = extractionGeneration(),
          .counters = {{"vertices", CounterKind::exact, "Of the mesh; blocks of 8 x 8 x 8 cells share none."},
                       {"triangles", CounterKind::exact, "Of the mesh."}},
          .layers = {PictureLayer::normal}};
}

} // namespace

TechniqueFactory marchingCubes() {
  return {.info = describe(),
          .create = []() -> std::unique_ptr<Technique> { return std::make_unique<MarchingCubes>(); },
          .whyUnsupported = whyExtractionUnsupported};
}

} // namespace volmark::mesh_isosurface
