#include "optimized_mesh.h"

#include "extracted_surface.h"
#include "meshlets.h"
#include "parts/marcher.h"
#include "volmark/error.h"

#include <fmt/format.h>

namespace volmark::mesh_isosurface {

namespace {

constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
                                      VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                                      VK_BUFFER_USAGE_TRANSFER_SRC_BIT;

bool asksForMeshShaders(const ParameterValues& parameters) {
  return parameters.text("pipeline") == "mesh";
}

/// A mesh on the device.
struct UploadedMesh {
  gpu::Buffer vertices;
  gpu::Buffer indices;
  gpu::Buffer meshlets;
  gpu::Buffer meshletVertices;
  gpu::Buffer meshletTriangles;
  std::uint32_t vertexCount = 0;
  std::uint32_t triangleCount = 0;
  std::uint32_t meshletCount = 0;
};

class OptimizedMeshTechnique final : public Technique {
public:
  void prepare(const Preparation& preparation, Recorder& recorder) override;
  void reset(std::uint64_t seed) override { m_seed = seed; }
  void update(const Changes& changes, const FrameInputs& inputs, Recorder& recorder) override;
  void draw(const Frame& frame, Recorder& recorder) override;
  std::vector<CounterValue> counters() const override {
    return {{"vertices", m_mesh.vertexCount}, {"triangles", m_mesh.triangleCount}, {"meshlets", m_mesh.meshletCount}};
  }
  std::optional<SurfaceMesh> surface() const override { return readBack(*m_device, indexed()); }
  std::vector<gpu::MemoryItem> memory() const override;

private:
  IndexedMesh indexed() const {
    return {.vertices = &m_mesh.vertices,
            .indices = &m_mesh.indices,
            .vertexCount = m_mesh.vertexCount,
            .triangleCount = m_mesh.triangleCount};
  }
  template <class Element>
  gpu::Buffer upload(const char* name, const std::vector<Element>& elements, bool isBound,
                     gpu::Commands& commands) const;
  void drawMeshlets(const Frame& frame, Recorder& recorder);

  gpu::Device* m_device = nullptr;
  std::optional<ExtractedSurface> m_surface;
  std::optional<IndexedDraw> m_indexed;              ///< vertex pipeline, or
  std::optional<parts::SurfacePipelines> m_meshlets; ///< mesh shaders
  UploadedMesh m_mesh;
  std::uint64_t m_seed = 0;
  std::vector<gpu::MemoryItem> m_prepared;
};

void OptimizedMeshTechnique::prepare(const Preparation& preparation, Recorder& recorder) {
  m_device = preparation.device;
  const std::vector<gpu::MemoryItem> before = m_device->ledger().items();
  m_surface.emplace(preparation, recorder);
  {
    const Pass pass = recorder.hostPass("pipelines");
    if (asksForMeshShaders(preparation.parameters)) {
      const VkDescriptorType own[] = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                      VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};
      const std::vector<gpu::ShaderSource> shaders = {
          {"mesh_isosurface/meshlet.mesh.glsl", VK_SHADER_STAGE_MESH_BIT_EXT, {}}};
      m_meshlets = m_surface->raster().makePipelines("meshlets", shaders, own, sizeof(MeshConstants));
    } else {
      m_indexed.emplace(m_surface->raster(), false);
    }
  }
  m_prepared = parts::memoryAdded(before, m_device->ledger().items());
}

template <class Element>
gpu::Buffer OptimizedMeshTechnique::upload(const char* name, const std::vector<Element>& elements, bool isBound,
                                           gpu::Commands& commands) const {
  const VkDeviceSize bytes = elements.size() * sizeof(Element);
  if (isBound && bytes > m_device->facts().maximumStorageBufferRange)
    throw UnsupportedError(fmt::format("the mesh needs {} bytes for {}, the device's storage buffers hold {}", bytes,
                                       name, m_device->facts().maximumStorageBufferRange));
  gpu::Buffer buffer(*m_device, {name, std::max<VkDeviceSize>(bytes, sizeof(Element)), kUsage});
  commands.upload(buffer, 0, std::as_bytes(std::span(elements)));
  return buffer;
}

void OptimizedMeshTechnique::update(const Changes&, const FrameInputs& inputs, Recorder& recorder) {
  if (!m_surface->update(inputs, recorder)) return;
  OptimizedMesh mesh;
  {
    // Its first stamp is behind the extraction, its last one in the next submission: the host's time lies between them.
    const Pass pass = recorder.pass("optimize");
    recorder.gpu().submitAndWait();
    mesh = optimize(readBack(*m_device, m_surface->extractor().mesh()), m_meshlets.has_value());
  }
  m_device->waitIdle(); // earlier frames may still be drawing the old one
  m_mesh = {};
  const Pass pass = recorder.pass("upload_mesh");
  gpu::Commands& commands = recorder.gpu();
  m_mesh.vertices = upload("mesh_vertices", mesh.vertices, false, commands);
  m_mesh.indices = upload("mesh_indices", mesh.indices, false, commands);
  if (m_meshlets) {
    m_mesh.meshlets = upload("meshlets", mesh.meshlets, true, commands);
    m_mesh.meshletVertices = upload("meshlet_vertices", mesh.meshletVertices, true, commands);
    m_mesh.meshletTriangles = upload("meshlet_triangles", mesh.meshletTriangles, true, commands);
  }
  m_mesh.vertexCount = static_cast<std::uint32_t>(mesh.vertices.size());
  m_mesh.triangleCount = static_cast<std::uint32_t>(mesh.indices.size() / 3);
  m_mesh.meshletCount = static_cast<std::uint32_t>(mesh.meshlets.size());
  commands.barrier(gpu::kTransferWrite, gpu::kAnything);
}

void OptimizedMeshTechnique::drawMeshlets(const Frame& frame, Recorder& recorder) {
  gpu::Commands& commands = recorder.gpu();
  const parts::SurfaceRaster& raster = m_surface->raster();
  const Pass pass = recorder.pass("draw_mesh");
  commands.barrier(gpu::kDrawWrite, gpu::kDrawWrite);
  const gpu::Rendering rendering(commands, raster.rendering(frame, true));
  raster.drawCaps(frame, recorder);
  if (m_mesh.meshletCount == 0) return;
  const gpu::Resource own[] = {m_mesh.meshlets.range(), m_mesh.meshletVertices.range(),
                               m_mesh.meshletTriangles.range()};
  const MeshConstants constants{.vertices = wordsOf(m_mesh.vertices.address()), .meshlets = m_mesh.meshletCount};
  commands.bind(parts::SurfaceRaster::choose(*m_meshlets, frame), raster.resources(own), gpu::bytesOf(constants));
  const glm::uvec3 groups = parts::rowsOf(m_mesh.meshletCount);
  m_device->cmdDrawMeshTasks(commands.handle(), groups.x, groups.y, groups.z);
}

void OptimizedMeshTechnique::draw(const Frame& frame, Recorder& recorder) {
  m_surface->raster().beginFrame(frame, m_seed, recorder);
  if (m_indexed)
    m_indexed->draw(frame, m_surface->raster(), indexed(), recorder);
  else
    drawMeshlets(frame, recorder);
}

std::vector<gpu::MemoryItem> OptimizedMeshTechnique::memory() const {
  std::vector<gpu::MemoryItem> items = memoryNow(m_prepared, m_surface->extractor());
  for (const gpu::Buffer* buffer :
       {&m_mesh.vertices, &m_mesh.indices, &m_mesh.meshlets, &m_mesh.meshletVertices, &m_mesh.meshletTriangles})
    if (*buffer) items.push_back(buffer->memory());
  return items;
}

TechniqueInfo describe() {
  std::vector<PassDescriptor> passes = extractionPasses();
  passes.push_back({"optimize", "Vertices shared, triangles ordered, meshlets cut: on the host."});
  passes.push_back({"upload_mesh", "The mesh back to the GPU."});
  passes.push_back({"draw_mesh", "The mesh, shaded. Its time is what the paper's reference shows."});
  return {.name = "optimized_mesh",
          .summary = "Isosurface as an optimized mesh that is made aside: what no extraction can beat.",
          .paper = "Kreskowski, Rendle, Froehlich: Efficient Direct Isosurface Rasterization of Scalar Volumes, 2022",
          .section = "4, the mesh reference (\"infinitely fast extraction\"): compare draw_ms, not frame_ms",
          .draws = Draws::isosurface,
          .maximumViews = gpu::kMaxViews,
          .shadings = parts::surfaceShadings(),
          .parameters = {ParameterDescriptor::choice("pipeline", "mesh", {"mesh", "vertex"},
                                                     "Meshlets of 64 vertices by mesh shaders, or an index buffer.")},
          .passes = std::move(passes),
          .generation = extractionGeneration(),
          .counters = {{"vertices", CounterKind::exact, "Of the mesh; all are shared."},
                       {"triangles", CounterKind::exact, "Of the mesh, without those that have no area."},
                       {"meshlets", CounterKind::exact,
                        "Of at most 64 vertices and 124 triangles; 0 with pipeline=vertex."}},
          .layers = {PictureLayer::normal}};
}

std::optional<std::string> whyUnsupported(const Scene& scene, const ParameterValues& parameters, const OutputSize& size,
                                          const gpu::Device* device) {
  const gpu::DeviceFacts& facts = device->facts();
  const auto views = static_cast<std::uint32_t>(size.views);
  if (asksForMeshShaders(parameters) && !facts.meshShader)
    return fmt::format("The device {} has no mesh shaders; pipeline=vertex needs none.", facts.name);
  if (asksForMeshShaders(parameters) &&
      (kMeshletVertices * views > facts.maximumMeshVertices || kMeshletTriangles * views > facts.maximumMeshPrimitives))
    return fmt::format("Meshlets of {} views need {} vertices and {} triangles, allowed by the device: {} and {}.",
                       views, kMeshletVertices * views, kMeshletTriangles * views, facts.maximumMeshVertices,
                       facts.maximumMeshPrimitives);
  return whyExtractionUnsupported(scene, parameters, size, device);
}

} // namespace

TechniqueFactory optimizedMesh() {
  return {.info = describe(),
          .create = []() -> std::unique_ptr<Technique> { return std::make_unique<OptimizedMeshTechnique>(); },
          .whyUnsupported = whyUnsupported};
}

} // namespace volmark::mesh_isosurface
