// What every ray marcher does on the host: the volume, two pipelines (timed and counting), one dispatch for all views.
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
};

class Marcher {
public:
  /// Generation passes "upload" and "pipelines". Reads the parameters filtering and jitter.
  Marcher(const Preparation& preparation, const MarcherDescription& description, Recorder& recorder);

  /// Records the pass "march". `own` is bound from kBindingOwn on. Sets stepLength and layers of `constants`.
  void march(const Frame& frame, std::uint64_t seed, MarchConstants constants, std::span<const gpu::Resource> own,
             Recorder& recorder) const;

  const gpu::VolumeTexture& volume() const { return m_volume; }

  /// Values of kCounter... after a counting frame.
  std::vector<std::uint64_t> counts() const { return m_counters.read(); }

private:
  gpu::Pipeline makePipeline(gpu::Device& device, MarcherDescription description, bool counting,
                             const Preparation& preparation) const;

  const Scene* m_scene;
  float m_stepLength;
  gpu::VolumeTexture m_volume;
  gpu::Pipeline m_timed;
  gpu::Pipeline m_counting;
  gpu::CounterBuffer m_counters;
};

/// The parameters that all ray marchers have: step, filtering, jitter.
ParameterDescriptor stepParameter(double value);
ParameterDescriptor filteringParameter();
ParameterDescriptor jitterParameter();

/// Descriptors of kCounterSamples to kCounterGradients, with the name and meaning of kCounterEnded.
std::vector<CounterDescriptor> counterDescriptors(const std::string& ended, const std::string& endedDocumentation);

std::optional<std::string> whyUnsupported(const Scene& scene, const ParameterValues& parameters, const OutputSize& size,
                                          const gpu::Device* device);

/// What `after` has over `before`, by name.
std::vector<gpu::MemoryItem> memoryAdded(const std::vector<gpu::MemoryItem>& before,
                                         const std::vector<gpu::MemoryItem>& after);

} // namespace volmark::parts
