// The CPU model of surface extraction: closed, oriented, of the right topology.
#include "parts/testing/random_scenes.h"
#include "parts/testing/surface_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace volmark::parts {
namespace {

Scene sceneOf(const ScalarField& field, glm::ivec3 dims) {
  return makeScene(makeVolume(field, dims, ScalarType::float32), ShadingModel::gooch);
}

TEST(SurfaceModel, ASphereIsOneAndATorusHasAHole) {
  const Scene sphere = sceneOf(ball, glm::ivec3(32));
  const SurfaceMesh mesh = modelSurface(sphere, 0.4);
  const Topology found = topologyOf(mesh);
  EXPECT_EQ(found.openSides, 0u);
  EXPECT_EQ(found.eulerCharacteristic, 2);
  // 1 - 2 r = isovalue, over the range that the voxels have, in a cube 32 wide.
  const Range range = sphere.volume->dataRange();
  const double radius = 16 * (1 - (range.minimum + 0.4 * (range.maximum - range.minimum)));
  EXPECT_NEAR(found.volume / (4.0 / 3 * std::numbers::pi * std::pow(radius, 3)), 1, 0.01);
  const auto ring = [](const glm::dvec3& p) {
    const glm::dvec3 q = p - 0.5;
    return std::clamp(1 - 4 * std::hypot(std::hypot(q.x, q.y) - 0.3, q.z), 0.0, 1.0);
  };
  const Topology torus = topologyOf(modelSurface(sceneOf(ring, glm::ivec3(40)), 0.5));
  EXPECT_EQ(torus.openSides, 0u);
  EXPECT_EQ(torus.eulerCharacteristic, 0);
  EXPECT_GT(torus.volume, 0);
}

TEST(SurfaceModel, NoiseIsWatertightAndManifold) {
  Numbers numbers(1);
  const glm::ivec3 dims(17, 15, 16);
  for (int i = 0; i < 20; ++i) {
    // Outside all around.
    const Scene scene = sceneOf(
        [&](const glm::dvec3& p) {
          const glm::ivec3 voxel(p * glm::dvec3(dims));
          const bool border = glm::any(glm::equal(voxel, glm::ivec3(0))) || glm::any(glm::equal(voxel, dims - 1));
          return border ? 0.0 : numbers.unit();
        },
        dims);
    const SurfaceMesh mesh = modelSurface(scene, numbers.between(0.1, 0.9));
    const Topology found = topologyOf(mesh);
    EXPECT_GT(mesh.triangles.size(), 500u);
    EXPECT_EQ(found.openSides, 0u);
    EXPECT_GT(found.volume, 0);
    EXPECT_EQ(found.eulerCharacteristic % 2, 0);
  }
}

} // namespace
} // namespace volmark::parts
