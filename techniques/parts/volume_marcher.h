// The host's half of direct volume rendering (emission_absorption.glsl): parameters, the transfer function as a table,
// counters. Techniques add what tells them where nothing is.
#pragma once

#include "parts/marcher.h"
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

class VolumeMarcher {
public:
  /// Generation passes "upload" and "pipelines". Reads the parameters of emissionParameters().
  VolumeMarcher(const Preparation& preparation, const VolumeMarcherDescription& description, Recorder& recorder);

  /// Passes "build_transfer_function" and "upload_transfer_function", if the function has changed.
  void update(const Changes& changes, const FrameInputs& inputs, Recorder& recorder);

  /// The pass "march". `own` follows the table.
  void draw(const Frame& frame, std::uint64_t seed, std::span<const gpu::Resource> own, Recorder& recorder) const;

  const gpu::VolumeTexture& volume() const { return m_marcher.volume(); }
  /// What the shader reads, after update().
  const TransferTable& table() const { return m_table; }
  double stepVoxels() const { return m_step; }
  bool isPreintegrated() const { return m_preintegrated; }

  /// Values of kCounter... after a counting frame.
  std::vector<std::uint64_t> counts() const { return m_marcher.counts(); }

private:
  static MarcherDescription marcherDescription(const ParameterValues& parameters,
                                               const VolumeMarcherDescription& description);

  double m_step;
  bool m_preintegrated;
  int m_tableSize;
  Marcher m_marcher;
  TransferTable m_table;
  gpu::Image m_tableImage;
  gpu::Sampler m_tableSampler;
  MarchConstants m_constants{};
};

/// step, transfer_function_kind, table_size, preintegrated_size, early_termination, termination_opacity, filtering,
/// jitter.
std::vector<ParameterDescriptor> emissionParameters();
/// build_transfer_function, upload_transfer_function, march.
std::vector<PassDescriptor> emissionPasses();
/// upload, pipelines.
std::vector<PassDescriptor> emissionGeneration();
/// samples, rays, terminated_rays, gradients, visible_samples.
std::vector<CounterDescriptor> emissionCounters();
/// Their values, from VolumeMarcher::counts().
std::vector<CounterValue> emissionCounterValues(const std::vector<std::uint64_t>& counts);
std::vector<ShadingModel> emissionShadings();

/// Sentence, if the device can't do what the parameters ask for.
std::optional<std::string> whyEmissionUnsupported(const Scene& scene, const ParameterValues& parameters,
                                                  const OutputSize& size, const gpu::Device* device);

} // namespace volmark::parts
