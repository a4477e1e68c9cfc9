#include "fixture.h"
#include "reference/field.h"

#include <gtest/gtest.h>

namespace volmark::reference {

TEST(Field, InterpolatesBetweenVoxelCentres) {
  const Grid grid{{3, 2, 4}, {1, 2, 0.5}};
  const Scene scene = sceneOf(grid, [&](const glm::dvec3& p) {
    const glm::dvec3 voxel = grid.toVoxel(p);
    return (voxel.x + 0.125 * voxel.y * voxel.z) / 4; // trilinear
  });
  const Field field(scene, 0);
  for (const glm::dvec3& voxel : {glm::dvec3(0), glm::dvec3(2, 1, 3), glm::dvec3(1.25, 0.5, 2.75)})
    EXPECT_NEAR(field.value(voxel), (voxel.x + 0.125 * voxel.y * voxel.z) / 4, 1e-7);
  EXPECT_EQ(field.value({-1, 5, 1}), field.value({0, 1, 1}));
  EXPECT_EQ(field.toVoxel(grid.toWorld({1.25, 0.5, 2.75})), glm::dvec3(1.25, 0.5, 2.75));
}

TEST(Field, EveryTypeIsNormalisedOverTheRange) {
  for (const ScalarType type : {ScalarType::int8, ScalarType::uint8, ScalarType::int16, ScalarType::uint16}) {
    // Bytes 200 and 100: low bytes of one voxel or two voxels, with and without a sign.
    std::vector<std::byte> bytes(2 * sizeOf(type));
    bytes.front() = std::byte{200};
    bytes.back() = std::byte{100};
    Scene scene;
    scene.volume = std::make_shared<Volume>("test", Grid{{2, 1, 1}, glm::dvec3(1)}, type, bytes);
    scene.visualisationRange = {-1000, 30000};
    const Field field(scene, 0);
    for (int i = 0; i < 2; ++i)
      EXPECT_EQ(field.corners({0, 0, 0})[static_cast<std::size_t>(i)], scene.normalised(scene.volume->value(i, 0, 0)));
  }
}

TEST(Field, ClampsAfterInterpolation) {
  // From -1 to 3: half-way it is 1 when clamped afterwards, and 0.5 when clamped before.
  const Scene scene = sceneOf({{2, 1, 1}, glm::dvec3(1)}, [](const glm::dvec3& p) { return 1 + 4 * p.x; });
  const Field field(scene, 0);
  EXPECT_EQ(field.value({0.5, 0, 0}), 1);
  EXPECT_EQ(field.value({0.375, 0, 0}), 0.5);
  EXPECT_EQ(field.value({0.1, 0, 0}), 0);
}

TEST(Field, GradientOfALinearFieldIsExactUpToTheSides) {
  const Grid grid{{4, 5, 6}, {2, 0.5, 1}};
  const glm::dvec3 slope(0.05, -0.2, 0.03);
  const Scene scene = sceneOf(grid, [&](const glm::dvec3& p) { return 0.5 + glm::dot(slope, p); });
  const Field field(scene, 0);
  for (const glm::dvec3& voxel : {glm::dvec3(0), glm::dvec3(3, 4, 5), glm::dvec3(0.3, 2.5, 4.9)})
    EXPECT_LT(glm::distance(field.gradient(voxel), slope), 1e-6);
}

TEST(Field, GradientReachesOneVoxelToEitherSide) {
  // 1 at voxel 3 only: seen from 2 to 4 exclusive of the middle, where both sides agree.
  const Grid grid{{7, 1, 1}, {2, 1, 1}};
  const Scene scene = sceneOf(grid, [](const glm::dvec3& p) { return p.x == 0 ? 1 : 0; });
  const Field field(scene, 0);
  const std::vector<std::pair<double, double>> expected = {{1, 0}, {1.5, 0.125}, {2, 0.25}, {3, 0}, {4, -0.25}, {5, 0}};
  for (const auto& [voxel, gradient] : expected)
    EXPECT_EQ(field.gradient({voxel, 0, 0}), glm::dvec3(gradient, 0, 0)) << voxel;
}

} // namespace volmark::reference
