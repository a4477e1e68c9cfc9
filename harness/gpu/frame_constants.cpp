#include "volmark/gpu/frame_constants.h"

#include "volmark/gpu/target.h"

#include <cassert>

namespace volmark::gpu {

namespace {

ViewConstants constantsOf(const View& view) {
  const Frustum& f = view.frustum;
  return {vec3(view.pose.position), vec3(view.pose.right), vec3(view.pose.up), vec3(view.pose.forward),
          vec4(f.left, f.right, f.down, f.up)};
}

void fillInputs(const FrameInputs& inputs, FrameConstants& constants) {
  assert(inputs.views.size() <= static_cast<std::size_t>(kMaxViews));
  assert(inputs.clippingPlanes.size() <= static_cast<std::size_t>(kMaxClippingPlanes));
  for (std::size_t i = 0; i < inputs.views.size(); ++i)
    constants.views[i] = constantsOf(inputs.views[i]);
  for (std::size_t i = 0; i < inputs.clippingPlanes.size(); ++i)
    constants.clippingPlanes[i] = vec4(vec3(inputs.clippingPlanes[i].normal), inputs.clippingPlanes[i].offset);
  constants.viewCount = static_cast<uint>(inputs.views.size());
  constants.clippingPlaneCount = static_cast<uint>(inputs.clippingPlanes.size());
  constants.isovalue = static_cast<float>(inputs.isovalue);
  constants.lightColor = vec3(inputs.light.color);
  constants.ambient = static_cast<float>(inputs.light.ambient);
  constants.headlight = inputs.light.headlight ? 1 : 0;
}

void fillScene(const Scene& scene, FrameConstants& constants) {
  const Grid& grid = scene.volume->grid();
  constants.boxMinimum = vec3(grid.boxMinimum());
  constants.boxMaximum = vec3(grid.boxMaximum());
  constants.spacing = vec3(grid.spacingMm);
  constants.dims = grid.dims;
  constants.smallestSpacing = static_cast<float>(grid.smallestSpacingMm());
  constants.shadingModel = static_cast<uint>(scene.shading.model);
  constants.surfaceColor = vec3(scene.shading.surfaceColor);
}

vec4 placeOf(const Light& light, const Grid& grid) {
  return light.isSpot() ? vec4(vec3(light.position(grid)), 1) : vec4(vec3(glm::normalize(light.direction)), 0);
}

ivec2 sizeOf(const Frame& frame) {
  if (frame.target) return {frame.target->width, frame.target->height};
  if (!frame.pictures) return {0, 0};
  assert(!frame.pictures->empty());
  return {frame.pictures->front().width, frame.pictures->front().height};
}

} // namespace

FrameConstants frameConstants(const Frame& frame, const Scene& scene, const VolumeTexture& texture,
                              std::uint64_t seed) {
  FrameConstants constants{};
  fillInputs(frame.inputs, constants);
  fillScene(scene, constants);
  constants.light = placeOf(frame.inputs.light, scene.volume->grid());
  constants.size = sizeOf(frame);
  constants.valueScale = texture.scale();
  constants.valueBias = texture.bias();
  constants.frameIndex = static_cast<uint>(frame.index);
  constants.seed = static_cast<uint>(seed ^ (seed >> 32));
  return constants;
}

} // namespace volmark::gpu
