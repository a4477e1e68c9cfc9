// Distances to what the transfer function shows, at a part of the volume's resolution.
#pragma once

#include "structure.h"
#include "volmark/gpu/buffer.h"
#include "volmark/gpu/image.h"
#include "volmark/gpu/pipeline.h"

namespace volmark::empty_space_skipping {

/// Bytes of the image that rays read: one a texel, or one an octant.
std::uint64_t distanceMapBytes(const StructureSettings& settings, const Grid& grid);

std::optional<std::string> whyDistanceMapUnsupported(const StructureSettings& settings, const Volume& volume,
                                                     const gpu::Device& device);

class DistanceMap final : public Structure {
public:
  DistanceMap(gpu::Device& device, const Scene& scene, const gpu::VolumeTexture& volume,
              const StructureSettings& settings);

  bool dependsOnTransferFunction() const override { return true; }
  void build(gpu::Commands& commands, const gpu::SampledImage& volume, const VisibleScalars& visible) override;
  std::vector<gpu::Resource> resources() const override;
  SkippingConstants constants(const VisibleScalars& kept, const VisibleScalars& beyond) const override;

  glm::ivec3 texels() const { return m_constants.blocks; }
  const gpu::Image& distances() const { return m_distances; }

private:
  void buildEuclidean(gpu::Commands& commands);
  void buildChebyshev(gpu::Commands& commands);
  /// One axis: from a buffer to another one, or, last, to the image's slices from `firstSlice` on.
  void transform(gpu::Commands& commands, const DistanceConstants& constants, const gpu::Buffer& before,
                 const gpu::Buffer* after) const;

  StructureSettings m_settings;
  BuildConstants m_constants;
  gpu::Image m_distances;
  gpu::Sampler m_sampler;
  gpu::Buffer m_occupied;
  gpu::Buffer m_alongX;
  gpu::Buffer m_alongY;
  gpu::Pipeline m_occupancy;
  gpu::Pipeline m_transform;
  gpu::Pipeline m_lastTransform;
  bool m_built = false;
};

} // namespace volmark::empty_space_skipping
