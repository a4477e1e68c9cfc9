// Scenes made of analytic fields, and cameras that look at them.
#pragma once

#include "reference/reference.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace volmark::reference {

using FieldFunction = std::function<double(const glm::dvec3& world)>;

/// A float32 volume with `field` at every voxel centre.
inline std::shared_ptr<const Volume> sampled(const Grid& grid, const FieldFunction& field) {
  std::vector<std::byte> bytes(grid.voxelCount() * sizeof(float));
  std::byte* voxel = bytes.data();
  for (int k = 0; k < grid.dims.z; ++k)
    for (int j = 0; j < grid.dims.y; ++j)
      for (int i = 0; i < grid.dims.x; ++i, voxel += sizeof(float)) {
        const float value = static_cast<float>(field(grid.toWorld(glm::dvec3(i, j, k))));
        std::memcpy(voxel, &value, sizeof(float));
      }
  return std::make_shared<Volume>("test", grid, ScalarType::float32, std::move(bytes));
}

/// A scene normalised over [0,1], unshaded.
inline Scene sceneOf(const Grid& grid, const FieldFunction& field) {
  Scene scene;
  scene.name = "test";
  scene.volume = sampled(grid, field);
  scene.visualisationRange = {0, 1};
  scene.shading.model = ShadingModel::none;
  return scene;
}

inline View viewFrom(const glm::dvec3& position, const glm::dvec3& up = {0, 1, 0}, double tangent = 0.5) {
  View view;
  view.pose = Pose::lookAt(position, glm::dvec3(0), up);
  view.frustum = {-tangent, tangent, -tangent, tangent};
  return view;
}

/// Control points of (value, opacity), all of one colour.
inline std::shared_ptr<const TransferFunction> opacities(std::vector<std::pair<double, double>> pairs,
                                                         const glm::dvec3& color = glm::dvec3(1)) {
  std::vector<ControlPoint> points;
  for (const auto& [value, opacity] : pairs)
    points.push_back({value, color, opacity});
  return std::make_shared<TransferFunction>("test", std::move(points));
}

inline FrameInputs inputsOf(const View& view, double isovalue = 0.5) {
  FrameInputs inputs;
  inputs.views = {view};
  inputs.isovalue = isovalue;
  inputs.transferFunction = opacities({{0, 0}, {1, 0.5}});
  return inputs;
}

/// The one pixel of a ray through the middle of the picture.
struct Seen {
  glm::vec4 color;
  float distance;
};
inline Seen seenOf(const Picture& picture) {
  const std::size_t middle = picture.index(picture.width / 2, picture.height / 2);
  return {picture.color[middle], picture.distance[middle]};
}
inline Seen surfaceInTheMiddle(const Scene& scene, const FrameInputs& inputs) {
  return seenOf(renderIsosurface(scene, inputs, 0, 1, 1));
}
inline glm::vec4 volumeInTheMiddle(const Scene& scene, const FrameInputs& inputs, const VolumeSamples& samples) {
  return seenOf(renderVolume(scene, inputs, 0, 1, 1, samples)).color;
}

} // namespace volmark::reference
