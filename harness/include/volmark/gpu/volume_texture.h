// The volume on the GPU: one 3-D image per resident time step, in the data's own type.
#pragma once

#include "volmark/gpu/commands.h"
#include "volmark/recorder.h"
#include "volmark/scene.h"

#include <optional>
#include <string>
#include <vector>

namespace volmark::gpu {

enum class Filtering { hardware, shader };

/// Signed integers are stored with the sign bit flipped (as UNORM), because SNORM maps the two lowest values
/// to one. Sampled values become normalised scalars by `scale * sampled + bias`, clamped to [0,1].
class VolumeTexture {
public:
  /// Uploads time steps [first, first+count) in the generation pass "upload". Throws UnsupportedError when
  /// the size, the format or hardware filtering is beyond the device.
  VolumeTexture(Device& device, const Scene& scene, Filtering filtering, Recorder& recorder, int first = 0,
                int count = 1);

  /// Why this would not work on a device, or nothing.
  static std::optional<std::string> whyUnsupported(const Device& device, const Volume& volume, Filtering filtering);

  /// The slot that was made for time step `step`, an absolute one in [first, first+count).
  SampledImage at(int step) const { return slot(step - m_first); }
  SampledImage slot(int index) const;
  /// Replaces one resident slot's voxels by those of time step `step` (streamed volumes); records into the current
  /// pass, with all the staging memory it needs.
  void upload(Commands& commands, const Volume& volume, int step, int slot);

  float scale() const { return m_scale; }
  float bias() const { return m_bias; }
  Filtering filtering() const { return m_filtering; }
  VkDeviceSize bytes() const;                                       ///< of all slots, as allocated
  MemoryItem memory() const { return {"volume texture", bytes()}; } ///< what it added to the ledger

private:
  void uploadInSlabs(Commands& commands, const Volume& volume, int step, int slot);

  Filtering m_filtering;
  int m_first;
  std::vector<Image> m_images; ///< one per slot
  Sampler m_sampler;
  float m_scale = 1;
  float m_bias = 0;
};

} // namespace volmark::gpu
