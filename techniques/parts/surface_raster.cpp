#include "parts/surface_raster.h"

#include "parts/marcher.h"
#include "parts/marching_cubes_table.h"
#include "parts/surface_level.h"
#include "volmark/gpu/frame_constants.h"
#include "volmark/gpu/target.h"

#include <algorithm>
#include <limits>

namespace volmark::parts {

namespace {

gpu::Image makeDepth(gpu::Device& device, const OutputSize& size) {
  return {device,
          {.name = "depth",
           .format = SurfaceRaster::kDepth,
           .extent = {static_cast<std::uint32_t>(size.width), static_cast<std::uint32_t>(size.height), 1},
           .layers = static_cast<std::uint32_t>(size.views),
           .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT}};
}

/// Largest voxel on a side of the box: what could be solid there.
double boundaryMaximum(const Scene& scene, int timeStep) {
  const Volume& volume = *scene.volume;
  const glm::ivec3 last = volume.grid().dims - 1;
  double largest = volume.value(0, 0, 0, timeStep);
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const int side : {0, last[axis]})
      for (int j = 0; j <= last[v]; ++j)
        for (int i = 0; i <= last[u]; ++i) {
          glm::ivec3 voxel;
          voxel[axis] = side;
          voxel[u] = i;
          voxel[v] = j;
          largest = std::max(largest, volume.value(voxel.x, voxel.y, voxel.z, timeStep));
        }
  }
  return scene.normalised(largest);
}

bool isInBox(const Grid& grid, const glm::dvec3& eye) {
  const glm::dvec3 slack(1e-3 * grid.smallestSpacingMm());
  return glm::all(glm::greaterThanEqual(eye, grid.boxMinimum() - slack)) &&
         glm::all(glm::lessThanEqual(eye, grid.boxMaximum() + slack));
}

void addVariants(std::vector<gpu::ShaderSource>& shaders, int views, bool clip, bool counting) {
  for (gpu::ShaderSource& shader : shaders) {
    shader.macros.emplace_back("VIEWS", std::to_string(views));
    if (clip && shader.stage != VK_SHADER_STAGE_FRAGMENT_BIT) shader.macros.emplace_back("CLIP", "1");
    if (counting) shader.macros.emplace_back("COUNTING", "1");
  }
}

} // namespace

SurfaceRaster::SurfaceRaster(const Preparation& preparation, int counters, Recorder& recorder)
    : m_device(preparation.device), m_scene(&preparation.scene),
      m_volume(*preparation.device, preparation.scene, gpu::Filtering::shader, recorder, 0,
               preparation.scene.volume->timeSteps()),
      m_counters(*preparation.device, std::max(counters, 1)),
      m_table(*preparation.device, {"marching_cubes_table", 256 * sizeof(std::uint64_t),
                                    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT}),
      m_depth(makeDepth(*preparation.device, preparation.size)), m_views(preparation.size.views) {
  registerPartsShaders();
  {
    const Pass pass = recorder.pass("upload_table");
    const auto table = packedMarchingCubesTable();
    recorder.gpu().upload(m_table, 0, std::as_bytes(std::span(table)));
    recorder.gpu().barrier(gpu::kTransferWrite, {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_SHADER_READ_BIT});
  }
  const Pass pass = recorder.hostPass("pipelines");
  for (int step = 0; step < preparation.scene.volume->timeSteps(); ++step)
    m_boundaryMaximum.push_back(boundaryMaximum(preparation.scene, step));
  const std::vector<gpu::ShaderSource> shaders = {{"parts/surface_caps.vert.glsl", VK_SHADER_STAGE_VERTEX_BIT, {}},
                                                  {"parts/surface_caps.frag.glsl", VK_SHADER_STAGE_FRAGMENT_BIT, {}}};
  for (const bool counting : {false, true})
    m_caps[counting] = makePipeline("caps", shaders, {}, 0, {}, DepthUse::all, false, counting);
}

std::vector<VkDescriptorType> SurfaceRaster::bindings(std::span<const VkDescriptorType> own) {
  std::vector<VkDescriptorType> all = {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                       VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                       VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

gpu::Specialisation SurfaceRaster::variant(bool counting, gpu::Specialisation own) const {
  return own.set(kIdSurfaceShadingModel, static_cast<std::uint32_t>(m_scene->shading.model))
      .set(kIdSurfaceCounting, counting);
}

gpu::Pipeline SurfaceRaster::makePipeline(const std::string& name, std::vector<gpu::ShaderSource> shaders,
                                          std::span<const VkDescriptorType> own, std::uint32_t pushConstantBytes,
                                          gpu::Specialisation ownVariant, DepthUse depth, bool clip,
                                          bool counting) const {
  addVariants(shaders, m_views, clip, counting);
  gpu::GraphicsPipelineDescription description;
  description.name = name + (clip ? " clipped" : "") + (counting ? " counting" : "");
  description.shaders = std::move(shaders);
  description.layout = {.bindings = bindings(own), .pushConstantBytes = pushConstantBytes};
  description.specialisation = variant(counting, std::move(ownVariant));
  if (depth != DepthUse::prepass) description.colorFormats = {gpu::kColorFormat, gpu::kDepthFormat};
  if (depth != DepthUse::prepass && counting) description.colorFormats.push_back(gpu::kNormalFormat);
  description.depthFormat = kDepth;
  // Nearer is greater.
  description.depthCompare = depth == DepthUse::afterPrepass ? VK_COMPARE_OP_GREATER_OR_EQUAL : VK_COMPARE_OP_GREATER;
  description.depthWrite = depth != DepthUse::afterPrepass;
  return {*m_device, description};
}

SurfacePipelines SurfaceRaster::makePipelines(const std::string& name, const std::vector<gpu::ShaderSource>& shaders,
                                              std::span<const VkDescriptorType> own, std::uint32_t pushConstantBytes,
                                              const gpu::Specialisation& ownVariant, DepthUse depth) const {
  std::vector<gpu::ShaderSource> all = shaders;
  if (depth != DepthUse::prepass) all.push_back({"parts/surface.frag.glsl", VK_SHADER_STAGE_FRAGMENT_BIT, {}});
  SurfacePipelines pipelines;
  for (const bool clip : {false, true})
    for (const bool counting : {false, true})
      pipelines.variants[clip][counting] =
          makePipeline(name, all, own, pushConstantBytes, ownVariant, depth, clip, counting);
  return pipelines;
}

const gpu::Pipeline& SurfaceRaster::choose(const SurfacePipelines& pipelines, const Frame& frame) {
  return pipelines.variants[!frame.inputs.clippingPlanes.empty()][frame.counting];
}

float SurfaceRaster::near() const {
  return static_cast<float>(1e-3 * m_scene->volume->grid().smallestSpacingMm());
}

SurfaceConstants SurfaceRaster::constantsOf(const FrameInputs& inputs) const {
  const SurfaceLevel level = surfaceLevel(*m_scene, inputs.isovalue);
  return {.threshold = level.threshold, .texel = level.texel, .near = near(), .layers = layersOf(inputs.views)};
}

void SurfaceRaster::beginUpdate(const FrameInputs& inputs, Recorder& recorder) {
  m_timeStep = inputs.timeStep;
  const Frame frame{.inputs = inputs};
  m_frameConstants = recorder.gpu().constants(gpu::frameConstants(frame, *m_scene, m_volume, 0));
  m_surfaceConstants = recorder.gpu().constants(constantsOf(inputs));
}

void SurfaceRaster::beginFrame(const Frame& frame, std::uint64_t seed, Recorder& recorder) {
  gpu::Commands& commands = recorder.gpu();
  m_timeStep = frame.inputs.timeStep;
  m_frameConstants = commands.constants(gpu::frameConstants(frame, *m_scene, m_volume, seed));
  m_surfaceConstants = commands.constants(constantsOf(frame.inputs));
  if (frame.counting) m_counters.clear(commands);
  commands.transition(m_depth, m_depthIsNew ? VK_IMAGE_LAYOUT_UNDEFINED : VK_IMAGE_LAYOUT_GENERAL,
                      VK_IMAGE_LAYOUT_GENERAL, gpu::kDrawWrite, gpu::kDrawWrite);
  m_depthIsNew = false;
}

std::vector<gpu::Resource> SurfaceRaster::resources(std::span<const gpu::Resource> own) const {
  std::vector<gpu::Resource> all = {m_frameConstants, m_volume.at(m_timeStep), m_surfaceConstants, m_table.range(),
                                    m_counters.range()};
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

gpu::RenderingDescription SurfaceRaster::rendering(const Frame& frame, bool clear) const {
  const gpu::Target& target = *frame.target;
  gpu::RenderingDescription description = depthOnly(frame, clear);
  const float infinity = std::numeric_limits<float>::infinity();
  description.colors = {{.view = target.color.view(), .clear = clear},
                        {.view = target.distance.view(), .clear = clear, .value = glm::vec4(infinity)}};
  if (frame.counting) description.colors.push_back({.view = target.normal.view(), .clear = clear});
  return description;
}

gpu::RenderingDescription SurfaceRaster::depthOnly(const Frame& frame, bool clear) const {
  return {.size = {frame.target->width, frame.target->height},
          .layers = static_cast<std::uint32_t>(frame.target->views),
          .depth = {.view = m_depth.view(), .clear = clear}};
}

bool SurfaceRaster::hasCaps(const FrameInputs& inputs) const {
  if (!inputs.clippingPlanes.empty()) return true;
  const auto step = static_cast<std::size_t>(inputs.timeStep);
  if (std::clamp(m_boundaryMaximum[step], 0.0, 1.0) >= inputs.isovalue - 1e-4) return true;
  return std::any_of(inputs.views.begin(), inputs.views.end(),
                     [&](const View& view) { return isInBox(m_scene->volume->grid(), view.pose.position); });
}

void SurfaceRaster::drawCaps(const Frame& frame, Recorder& recorder) const {
  if (!hasCaps(frame.inputs)) return;
  gpu::Commands& commands = recorder.gpu();
  commands.bind(m_caps[frame.counting], resources({}));
  vkCmdDraw(commands.handle(), 3, static_cast<std::uint32_t>(frame.inputs.views.size()), 0, 0);
}

std::vector<ShadingModel> surfaceShadings() {
  return {ShadingModel::gooch, ShadingModel::none, ShadingModel::lambert, ShadingModel::phong, ShadingModel::ggx};
}

std::optional<std::string> whySurfaceUnsupported(const Scene& scene, const gpu::Device* device) {
  if (!device->facts().vertexLayer) return "The device's vertex shaders can't choose a layer (shaderOutputLayer).";
  if (!device->facts().vertexStores) return "The device's vertex stages can't count (vertexPipelineStoresAndAtomics).";
  return gpu::VolumeTexture::whyUnsupported(*device, *scene.volume, gpu::Filtering::shader);
}

} // namespace volmark::parts
