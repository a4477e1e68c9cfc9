// The host's half of direct volume rendering (emission_absorption.glsl): parameters, the transfer function as a table,
// counters. Techniques add what tells them where nothing is.
#pragma once

#include "parts/marcher.h"
#include "parts/shadow_map.h"
#include "parts/transfer_table.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace volmark::parts {

/// What a technique adds to plain marching.
struct VolumeMarcherDescription {
  std::string shader;                                        ///< "<family>/<file>"
  std::vector<std::pair<std::string, std::string>> macros{}; ///< beside PREINTEGRATED
  gpu::Specialisation variant{};                             ///< constants from kIdOwn on
  std::vector<VkDescriptorType> own{};                       ///< bindings after the table
};

/// The labels of a scene's volume as a scene of their own: scalars are labels / 255.
Scene sceneOfLabels(const Scene& scene);

/// A bit each.
uvec4 bitsOf(const std::bitset<kMaximumSegments>& segments);

/// A transfer function as rays read it, on host and device.
struct TableOnGpu {
  TransferTable table;
  gpu::Image image;
};

class VolumeMarcher {
public:
  /// Generation passes "upload" and "pipelines". Reads the parameters of emissionParameters(), the scene's shadows and
  /// what it draws beyond clipping planes.
  VolumeMarcher(const Preparation& preparation, const VolumeMarcherDescription& description, Recorder& recorder);

  /// Passes "build_transfer_function" and "upload_transfer_function", if the function has changed.
  void update(const Changes& changes, const FrameInputs& inputs, Recorder& recorder);

  /// The passes "shadow_map", if the scene has shadows, and "march". `own` follows the table.
  void draw(const Frame& frame, std::uint64_t seed, std::span<const gpu::Resource> own, Recorder& recorder) const;

  const gpu::VolumeTexture& volume() const { return m_marcher.volume(); }
  /// uint8; absent if the volume has none.
  const std::optional<gpu::VolumeTexture>& labels() const { return m_labels; }
  /// What the shader reads, after update().
  const TransferTable& table() const { return m_kept.table; }
  /// The same of what clipping planes cut off; null if that is not drawn.
  const TransferTable* tableBeyond() const { return m_beyond ? &m_beyond->table : nullptr; }
  double stepVoxels() const { return m_step; }
  bool isPreintegrated() const { return m_preintegrated; }

  /// Values of kCounter... after a counting frame.
  std::vector<std::uint64_t> counts() const { return m_marcher.counts(); }

private:
  void makePipelines(const Preparation& preparation, const VolumeMarcherDescription& description);
  TableOnGpu makeTable(gpu::Device& device, const char* name) const;
  void fill(TableOnGpu& table, const TransferFunction& function, Recorder& recorder) const;
  void drawShadowMap(const Frame& frame, std::vector<gpu::Resource> resources, const MarchConstants& constants,
                     Recorder& recorder) const;

  double m_step;
  bool m_preintegrated;
  int m_tableSize;
  double m_shadowBias; ///< voxels
  Marcher m_marcher;
  const Scene* m_scene;
  std::optional<gpu::VolumeTexture> m_labels;
  TableOnGpu m_kept;
  std::optional<TableOnGpu> m_beyond;
  gpu::Sampler m_tableSampler;
  MarchPipelines m_pipelines;
  std::optional<ShadowMap> m_shadows;
  MarchPipelines m_shadowPipelines;
  MarchConstants m_constants{};
};

/// step, transfer_function_kind, table_size, preintegrated_size, early_termination, termination_opacity, filtering,
/// jitter, shadow_resolution, shadow_bias.
std::vector<ParameterDescriptor> emissionParameters();
/// build_transfer_function, upload_transfer_function, shadow_map, march.
std::vector<PassDescriptor> emissionPasses();
/// upload, pipelines.
std::vector<PassDescriptor> emissionGeneration();
/// samples, rays, terminated_rays, gradients, visible_samples, shadow_samples.
std::vector<CounterDescriptor> emissionCounters();
/// Their values, from VolumeMarcher::counts().
std::vector<CounterValue> emissionCounterValues(const std::vector<std::uint64_t>& counts);
std::vector<ShadingModel> emissionShadings();

/// Sentence, if the device can't do what the parameters ask for.
std::optional<std::string> whyEmissionUnsupported(const Scene& scene, const ParameterValues& parameters,
                                                  const OutputSize& size, const gpu::Device* device);

} // namespace volmark::parts
