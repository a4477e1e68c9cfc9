// What every rasterising technique does on the host: the volume, depth, pipelines, constants of a frame, and caps: what
// is solid where rays enter the volume, where a mesh has no triangles.
#pragma once

#include "parts/surface_shared.h"
#include "volmark/gpu/counter_buffer.h"
#include "volmark/gpu/rendering.h"
#include "volmark/gpu/volume_texture.h"
#include "volmark/technique.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace volmark::parts {

/// How a draw treats depth.
enum class DepthUse {
  all,          ///< tests and writes
  prepass,      ///< that alone, without colours
  afterPrepass, ///< draws what the prepass left
};

/// Of one technique's draw: with or without clipping planes, timed or counting.
struct SurfacePipelines {
  gpu::Pipeline variants[2][2];
};

class SurfaceRaster {
public:
  /// Generation passes "upload", all time steps, "upload_table" and "pipelines".
  /// `counters`: how many the technique has.
  SurfaceRaster(const Preparation& preparation, int counters, Recorder& recorder);

  /// The bindings of all surface shaders, then `own` from kSurfaceOwn on.
  static std::vector<VkDescriptorType> bindings(std::span<const VkDescriptorType> own);
  /// Constants of all surface shaders beside the technique's own.
  gpu::Specialisation variant(bool counting, gpu::Specialisation own = {}) const;
  /// Pipelines from shaders before rasterisation (macros VIEWS, of the picture, CLIP, with clipping planes, and
  /// COUNTING) and
  /// surface.frag.glsl.
  SurfacePipelines makePipelines(const std::string& name, const std::vector<gpu::ShaderSource>& shaders,
                                 std::span<const VkDescriptorType> own, std::uint32_t pushConstantBytes,
                                 const gpu::Specialisation& ownVariant = {}, DepthUse depth = DepthUse::all) const;
  static const gpu::Pipeline& choose(const SurfacePipelines& pipelines, const Frame& frame);

  /// Before the first pass of a frame: its constants; counters are zero again in counting frames.
  void beginFrame(const Frame& frame, std::uint64_t seed, Recorder& recorder);
  /// Constants without a frame, for work in update(): of the level alone.
  void beginUpdate(const FrameInputs& inputs, Recorder& recorder);
  /// Those of all surface shaders, then `own`.
  std::vector<gpu::Resource> resources(std::span<const gpu::Resource> own) const;

  /// Colour, distance, in counting frames normals, and depth.
  gpu::RenderingDescription rendering(const Frame& frame, bool clear) const;
  gpu::RenderingDescription depthOnly(const Frame& frame, bool clear) const;

  /// Whether anything is solid where a ray may enter: never said no wrongly.
  bool hasCaps(const FrameInputs& inputs) const;
  /// Records all of it, if hasCaps(), inside of a rendering.
  void drawCaps(const Frame& frame, Recorder& recorder) const;

  gpu::SampledImage voxels(int timeStep) const { return m_volume.at(timeStep); }
  std::vector<std::uint64_t> counts() const { return m_counters.read(); }
  static constexpr VkFormat kDepth = VK_FORMAT_D32_SFLOAT;

private:
  /// Distance of the near plane, world units.
  float near() const;
  SurfaceConstants constantsOf(const FrameInputs& inputs) const;
  gpu::Pipeline makePipeline(const std::string& name, std::vector<gpu::ShaderSource> shaders,
                             std::span<const VkDescriptorType> own, std::uint32_t pushConstantBytes,
                             gpu::Specialisation ownVariant, DepthUse depth, bool clip, bool counting) const;

  gpu::Device* m_device;
  const Scene* m_scene;
  gpu::VolumeTexture m_volume;
  gpu::CounterBuffer m_counters;
  gpu::Buffer m_table;
  gpu::Image m_depth;
  int m_views;
  bool m_depthIsNew = true;
  gpu::Pipeline m_caps[2];               ///< timed, counting
  std::vector<double> m_boundaryMaximum; ///< of each time step, normalised
  gpu::BufferRange m_frameConstants;
  gpu::BufferRange m_surfaceConstants;
  int m_timeStep = 0;
};

std::vector<ShadingModel> surfaceShadings();

/// Why no rasterising technique can draw this (one sentence), or nothing.
std::optional<std::string> whySurfaceUnsupported(const Scene& scene, const gpu::Device* device);

} // namespace volmark::parts
