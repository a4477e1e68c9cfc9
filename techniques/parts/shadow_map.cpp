#include "parts/shadow_map.h"

#include <cmath>

namespace volmark::parts {

ShadowMap::ShadowMap(gpu::Device& device, int size)
    : m_size(size), m_image(device, {.name = "shadow_map",
                                     .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                     .extent = {static_cast<std::uint32_t>(size), static_cast<std::uint32_t>(size), 1},
                                     .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT}),
      m_sampler(device, VK_FILTER_NEAREST) {
}

void ShadowMap::describe(const Light& light, const Grid& grid, double biasVoxels, MarchConstants& constants) const {
  const glm::dvec3 forward = -light.direction;
  // Any two axes will do: the one that the light looks along least makes them.
  glm::dvec3 axis(0);
  const glm::dvec3 along = glm::abs(forward);
  axis[along.x <= along.y && along.x <= along.z ? 0 : along.y <= along.z ? 1 : 2] = 1;
  const glm::dvec3 right = glm::normalize(glm::cross(forward, axis));
  constants.shadowRight = vec3(right);
  constants.shadowUp = vec3(glm::cross(right, forward));
  constants.shadowForward = vec3(forward);
  // Tangents to the sphere.
  constants.shadowTangent = static_cast<float>(1 / std::sqrt(light.distance * light.distance - 1));
  constants.shadowBias = static_cast<float>(biasVoxels * grid.smallestSpacingMm());
  constants.shadowSize = m_size;
}

void ShadowMap::beginWriting(gpu::Commands& commands) const {
  // Earlier frames may still be reading; what they left is not needed.
  commands.transition(m_image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL, gpu::kComputeRead,
                      gpu::kComputeWrite);
}

void ShadowMap::endWriting(gpu::Commands& commands) const {
  commands.barrier(gpu::kComputeWrite, gpu::kComputeRead);
}

} // namespace volmark::parts
