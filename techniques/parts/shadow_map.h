// The image and the frame of a shadow map (shadows.glsl).
#pragma once

#include "parts/shared.h"
#include "volmark/gpu/commands.h"
#include "volmark/scene.h"

namespace volmark::parts {

class ShadowMap {
public:
  /// `size` texels along each side.
  ShadowMap(gpu::Device& device, int size);

  /// Sees the bounding sphere of the volume from the spotlight: sets the members of `constants` that are of shadows.
  void describe(const Light& light, const Grid& grid, double biasVoxels, MarchConstants& constants) const;

  /// Before a frame's rays of the light, and after them.
  void beginWriting(gpu::Commands& commands) const;
  void endWriting(gpu::Commands& commands) const;

  gpu::StorageImage written() const { return {m_image.layerView(0)}; }
  gpu::SampledImage read() const { return {m_image.layerView(0), m_sampler.handle(), VK_IMAGE_LAYOUT_GENERAL}; }

private:
  int m_size;
  gpu::Image m_image;
  gpu::Sampler m_sampler;
};

} // namespace volmark::parts
