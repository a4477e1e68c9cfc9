// What every ray marcher does on the host: the volume, pairs of pipelines (timed and counting), one dispatch for all
// views.
#pragma once

#include "parts/shared.h"
#include "volmark/gpu/counter_buffer.h"
#include "volmark/gpu/volume_texture.h"
#include "volmark/shared/frame_constants.h"
#include "volmark/technique.h"

#include <span>
#include <string>
#include <vector>

namespace volmark::parts {

/// Makes <parts/...> known to the compiler. A Marcher does so itself.
void registerPartsShaders();

/// What differs between the techniques, and between their parameters.
struct MarcherDescription {
  gpu::ShaderSource shader;
  gpu::Specialisation variant;       ///< the technique's own constants
  std::vector<VkDescriptorType> own; ///< of bindings kBindingOwn and following
  /// The shader is a fragment shader (with the macro FRAGMENT), drawn over the whole picture of each view.
  bool isFragment = false;
};

struct MarchPipelines {
  gpu::Pipeline timed;
  gpu::Pipeline counting;
};

class Marcher {
public:
  /// Generation pass "upload". Reads the parameters filtering and jitter.
  Marcher(const Preparation& preparation, Recorder& recorder);

  MarchPipelines makePipelines(const Preparation& preparation, MarcherDescription description) const;

  /// Before the first pass of a frame.
  void beginFrame(const Frame& frame, Recorder& recorder) const;

  /// Records the pass "march", all views. `own` is bound from kBindingOwn on. Sets stepLength and layers of
  /// `constants`.
  void march(const MarchPipelines& pipelines, const Frame& frame, std::uint64_t seed, const MarchConstants& constants,
             std::span<const gpu::Resource> own, Recorder& recorder) const;

  /// Records the pass "shadow_map": rays of the light, for constants.shadowSize squared texels.
  void marchFromLight(const MarchPipelines& pipelines, const Frame& frame, const MarchConstants& constants,
                      std::span<const gpu::Resource> own, Recorder& recorder) const;

  const gpu::VolumeTexture& volume() const { return m_volume; }

  /// Values of kCounter... after a counting frame.
  std::vector<std::uint64_t> counts() const { return m_counters.read(); }

private:
  gpu::Pipeline makePipeline(const Preparation& preparation, MarcherDescription description, bool counting) const;
  void dispatch(const MarchPipelines& pipelines, const Frame& frame, std::uint64_t seed, MarchConstants constants,
                std::span<const gpu::Resource> own, glm::uvec3 groups, Recorder& recorder) const;

  const Scene* m_scene;
  float m_stepLength;
  gpu::VolumeTexture m_volume;
  gpu::CounterBuffer m_counters;
};

/// Output layer of view i in byte i.
std::uint32_t layersOf(const std::vector<View>& views);

/// The parameters that all ray marchers have: step, filtering, jitter.
ParameterDescriptor stepParameter(double value);
ParameterDescriptor filteringParameter();
gpu::Filtering filteringOf(const ParameterValues& parameters);
ParameterDescriptor jitterParameter();

/// Descriptors of kCounterSamples to kCounterGradients, with the name and meaning of kCounterEnded.
std::vector<CounterDescriptor> counterDescriptors(const std::string& ended, const std::string& endedDocumentation);

std::optional<std::string> whyUnsupported(const Scene& scene, const ParameterValues& parameters, const OutputSize& size,
                                          const gpu::Device* device);

/// What `after` has over `before`, by name.
std::vector<gpu::MemoryItem> memoryAdded(const std::vector<gpu::MemoryItem>& before,
                                         const std::vector<gpu::MemoryItem>& after);

} // namespace volmark::parts
