#include "fixture.h"

#include <gtest/gtest.h>

namespace volmark::reference {

namespace {

const Grid kCell{{2, 2, 2}, glm::dvec3(1)};

double awayFromEye(const glm::dvec3& p) {
  return 0.5 - p.z; // 0 at the side z = 0.5 that a camera at +z sees, 1 at the other
}

/// 0.5 on a sphere of radius 1.
double sphere(const glm::dvec3& p) {
  return 0.5 + 0.25 * (1 - glm::length(p));
}

/// A cube of `n` voxels a side, 3 units long.
Grid cube(int n) {
  return {glm::ivec3(n), glm::dvec3(3.0 / (n - 1))};
}

/// The view whose single pixel looks from `eye` exactly at `point`, along -z.
View viewThrough(const glm::dvec3& eye, const glm::dvec3& point) {
  View view;
  view.pose = {eye, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
  const glm::dvec3 d = (point - eye) / (eye.z - point.z);
  view.frustum = {d.x - 1e-3, d.x + 1e-3, d.y - 1e-3, d.y + 1e-3};
  return view;
}

} // namespace

TEST(Isosurface, OneCellWithARamp) {
  const Scene scene = sceneOf(kCell, awayFromEye);
  for (const double isovalue : {0.1, 0.3, 0.999}) {
    const Seen seen = surfaceInTheMiddle(scene, inputsOf(viewFrom({0, 0, 10}), isovalue));
    EXPECT_FLOAT_EQ(seen.distance, static_cast<float>(9.5 + isovalue));
    EXPECT_EQ(seen.color, glm::vec4(scene.shading.surfaceColor, 1));
  }
}

TEST(Isosurface, MissesAreTransparentAndInfinitelyFar) {
  const Scene scene = sceneOf(kCell, [](const glm::dvec3&) { return 0.2; });
  const Seen seen = surfaceInTheMiddle(scene, inputsOf(viewFrom({0, 0, 10}), 0.3));
  EXPECT_EQ(seen.distance, HUGE_VALF);
  EXPECT_EQ(seen.color, glm::vec4(0));
}

// The trilinear interpolant of a linear field is the field itself, whatever the spacing and the direction.
TEST(Isosurface, ObliquePlanesAreExact) {
  const Grid grid{{4, 7, 3}, {1.5, 0.4, 2.5}};
  const glm::dvec3 gradient(0.05, -0.1, -0.08);
  const Scene scene = sceneOf(grid, [&](const glm::dvec3& p) { return 0.5 + glm::dot(gradient, p); });
  const View view = viewFrom({3, -4, 9}, {0, 1, 0}, 0.3);
  const Picture picture = renderIsosurface(scene, inputsOf(view, 0.47), 0, 40, 30);
  int hits = 0;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) {
      const float distance = picture.distance[picture.index(x, y)];
      if (std::isinf(distance)) continue;
      const Ray ray = rayThroughPixel(view, x, y, 40, 30);
      const double value = 0.5 + glm::dot(gradient, ray.origin + ray.direction * (distance / ray.cosine));
      // Rays that start inside hit the box.
      EXPECT_GE(value, 0.47 - 1e-6);
      hits += value < 0.47 + 1e-6;
    }
  EXPECT_GT(hits, 50);
}

TEST(Isosurface, ErrorOnASphereFallsWithTheSquareOfTheSpacing) {
  const View view = viewFrom({0, 0, 6}, {0, 1, 0}, 0.1);
  double previous = 0;
  for (const int n : {11, 21, 41}) {
    const Picture picture = renderIsosurface(sceneOf(cube(n), sphere), inputsOf(view), 0, 32, 32);
    double worst = 0;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        const Ray ray = rayThroughPixel(view, x, y, 32, 32);
        const double along = -glm::dot(ray.origin, ray.direction);
        const double exact = along - std::sqrt(along * along - 36 + 1);
        worst = std::max(worst, std::abs(picture.distance[picture.index(x, y)] / ray.cosine - exact));
      }
    if (previous > 0) {
      EXPECT_GT(previous / worst, 3);
      EXPECT_LT(previous / worst, 6);
    }
    previous = worst;
  }
  EXPECT_LT(previous, 3e-3);
}

// The normal of a sphere seen from the side that is lit: n.l follows from the hit point.
TEST(Isosurface, NormalsPointOutwards) {
  Scene scene = sceneOf(cube(81), sphere);
  scene.shading = {ShadingModel::lambert, glm::dvec3(1)};
  FrameInputs inputs = inputsOf(viewFrom({0, 0, 6}, {0, 1, 0}, 0.12));
  inputs.light = {
      .headlight = false, .direction = glm::normalize(glm::dvec3(1, 1, 1)), .color = glm::dvec3(1), .ambient = 0.0};
  const Picture picture = renderIsosurface(scene, inputs, 0, 24, 24);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) {
      const Ray ray = rayThroughPixel(inputs.views[0], x, y, 24, 24);
      const double distance = picture.distance[picture.index(x, y)];
      const glm::dvec3 normal = glm::normalize(ray.origin + ray.direction * (distance / ray.cosine));
      const double expected = std::max(glm::dot(normal, inputs.light.direction), 0.0);
      EXPECT_NEAR(picture.color[picture.index(x, y)].r, expected, 0.01);
    }
}

TEST(Isosurface, ThinShellInsideACellIsFound) {
  // Along the diagonal (s, s, 1/2) of this cell the field is 4 s (1 - s): above 0.999 only near the middle.
  const Scene scene = sceneOf(kCell, [](const glm::dvec3& p) { return p.x * p.z < 0 ? 2.0 : 0.0; });
  FrameInputs inputs = inputsOf(viewFrom({-5, 0, -5}), 0.999);
  const double s = 0.5 - std::sqrt(0.25 - 0.999 / 4);
  const Seen seen = surfaceInTheMiddle(scene, inputs);
  EXPECT_NEAR(seen.distance, (4.5 + s) * std::sqrt(2.0), 1e-6);
}

TEST(Isosurface, StartingInsideHitsTheSideOfTheBox) {
  Scene scene = sceneOf(kCell, [](const glm::dvec3& p) { return 0.5 + p.z; });
  scene.shading = {ShadingModel::lambert, glm::dvec3(1)};
  FrameInputs inputs = inputsOf(viewFrom({0.1, 0.2, 10}));
  inputs.light = {.headlight = false, .direction = {0.6, 0, 0.8}, .color = glm::dvec3(1), .ambient = 0.0};
  const Seen seen = surfaceInTheMiddle(scene, inputs);
  EXPECT_NEAR(seen.distance, glm::length(glm::dvec3(0.1, 0.2, 10)) * 0.95, 1e-6);
  EXPECT_NEAR(seen.color.r, 0.8, 1e-6);
}

TEST(Isosurface, StartingInsideHitsTheClippingPlane) {
  Scene scene = sceneOf(cube(21), sphere);
  scene.shading = {ShadingModel::lambert, glm::dvec3(1)};
  FrameInputs inputs = inputsOf(viewFrom({0, 0, 6}));
  inputs.light = {.headlight = false, .direction = {0, 0, 1}, .color = glm::dvec3(1), .ambient = 0.0};
  inputs.clippingPlanes = {{{0, -1.2, -1.6}, -0.4}}; // keeps 0.6 y + 0.8 z <= 0.2, which cuts the axis at 0.25
  const Seen seen = surfaceInTheMiddle(scene, inputs);
  EXPECT_NEAR(seen.distance, 5.75, 1e-6);
  EXPECT_NEAR(seen.color.r, 0.8, 1e-6);
}

TEST(Isosurface, EyeInsideHitsAtOnce) {
  Scene scene = sceneOf(cube(21), sphere);
  scene.shading = {ShadingModel::lambert, glm::dvec3(1)};
  const Seen inside = surfaceInTheMiddle(scene, inputsOf(viewFrom({0, 0, 0.5})));
  EXPECT_EQ(inside.distance, 0);
  EXPECT_FLOAT_EQ(inside.color.r, 1);
  // In the box but outside the sphere: the surface is in front.
  EXPECT_NEAR(surfaceInTheMiddle(scene, inputsOf(viewFrom({0, 0, 1.4}))).distance, 0.4, 0.01);
}

TEST(Isosurface, IsovaluesAtTheEndsOfTheRange) {
  // The data exceed the visualisation range on both sides: -1 at the eye's side to 3 at the other.
  const Scene scene = sceneOf(kCell, [](const glm::dvec3& p) { return 4 * awayFromEye(p) - 1; });
  const auto distance = [&](double isovalue) {
    return surfaceInTheMiddle(scene, inputsOf(viewFrom({0, 0, 10}), isovalue)).distance;
  };
  EXPECT_FLOAT_EQ(distance(0), 9.5f);
  EXPECT_FLOAT_EQ(distance(1e-9), 9.75f);
  EXPECT_FLOAT_EQ(distance(0.5), 9.875f);
  EXPECT_FLOAT_EQ(distance(1), 10.0f);
  EXPECT_EQ(distance(1.001), HUGE_VALF);
}

TEST(Isosurface, PlateauAtTheIsovalueIsInside) {
  // Voxels 0, 1, 1 along z, of odd data that normalise with rounding.
  const Grid grid{{2, 2, 3}, glm::dvec3(1)};
  Scene scene = sceneOf(grid, [](const glm::dvec3& p) { return p.z > 0.5 ? -0.3f : 0.7f; });
  scene.visualisationRange = scene.volume->dataRange();
  EXPECT_FLOAT_EQ(surfaceInTheMiddle(scene, inputsOf(viewFrom({0, 0, 10}), 1)).distance, 10.0f);
  scene.visualisationRange = {-1.1, 2.3};
  const double isovalue = scene.normalised(static_cast<double>(0.7f));
  EXPECT_FLOAT_EQ(surfaceInTheMiddle(scene, inputsOf(viewFrom({0, 0, 10}), isovalue)).distance, 10.0f);
}

TEST(Isosurface, AxisOfOneVoxelIsAPlane) {
  const Grid grid{{9, 9, 1}, glm::dvec3(1)};
  const Scene scene = sceneOf(grid, [](const glm::dvec3& p) { return p.x > 0 ? 1.0 : 0.0; });
  const View view = viewFrom({0, 0, 10}, {0, 1, 0}, 0.35);
  const Picture picture = renderIsosurface(scene, inputsOf(view), 0, 8, 8);
  for (int x = 0; x < 8; ++x)
    EXPECT_EQ(picture.distance[picture.index(x, 4)], x < 5 ? HUGE_VALF : 10.0f) << x;
  // Edge on, along the plane, and a volume of a single voxel.
  EXPECT_FLOAT_EQ(surfaceInTheMiddle(scene, inputsOf(viewFrom({-10, 0, 0}))).distance, 10.5f);
  const Scene voxel = sceneOf({{1, 1, 1}, glm::dvec3(1)}, [](const glm::dvec3&) { return 1.0; });
  EXPECT_FLOAT_EQ(surfaceInTheMiddle(voxel, inputsOf(viewFrom({0, 0, 10}))).distance, 10.0f);
}

TEST(Isosurface, TimeStepsAndIntegerTypes) {
  // Two time steps of 2x2x2 int8 voxels: a ramp in z, rising away from the eye at +z and then towards it.
  std::vector<std::byte> bytes;
  for (const int first : {100, -28})
    for (int i = 0; i < 8; ++i)
      bytes.push_back(static_cast<std::byte>(i < 4 ? first : 72 - first));
  Scene scene = sceneOf(kCell, awayFromEye);
  scene.volume = std::make_shared<Volume>("steps", kCell, ScalarType::int8, bytes, 2);
  scene.visualisationRange = scene.volume->dataRange();
  FrameInputs inputs = inputsOf(viewFrom({0, 0, 10}), 0.25);
  EXPECT_FLOAT_EQ(surfaceInTheMiddle(scene, inputs).distance, 9.75f);
  inputs.timeStep = 1;
  EXPECT_FLOAT_EQ(surfaceInTheMiddle(scene, inputs).distance, 9.5f);
}

TEST(Isosurface, QuarterTurnsOfASymmetricVolumeLookTheSame) {
  Scene scene = sceneOf(cube(17), [](const glm::dvec3& p) {
    return sphere(p) + 0.1 * std::cos(4 * p.x) * std::cos(4 * p.z) * std::cos(4 * p.y);
  });
  scene.shading.model = ShadingModel::phong;
  const Picture front = renderIsosurface(scene, inputsOf(viewFrom({0, 0, 5})), 0, 33, 33);
  const std::vector<View> turned = {viewFrom({5, 0, 0}), viewFrom({0, 0, -5}), viewFrom({-5, 0, 0}),
                                    viewFrom({0, 5, 0}, {0, 0, -1}), viewFrom({0, 0, 5}, {1, 0, 0})};
  for (const View& view : turned) {
    const Picture picture = renderIsosurface(scene, inputsOf(view), 0, 33, 33);
    for (std::size_t i = 0; i < front.color.size(); ++i) {
      ASSERT_EQ(std::isinf(picture.distance[i]), std::isinf(front.distance[i]));
      if (!std::isinf(front.distance[i])) {
        EXPECT_NEAR(picture.distance[i], front.distance[i], 1e-5);
      }
      EXPECT_LT(glm::distance(picture.color[i], front.color[i]), 1e-4f);
    }
  }
}

// A point of the surface that one eye sees on a convex body lies at the same depth for the other eye.
TEST(Isosurface, EyesSeeTheSameSurface) {
  const Scene scene = sceneOf(cube(31), sphere);
  FrameInputs inputs = inputsOf(viewThrough({-0.1, 0, 6}, {0, 0, 0}));
  inputs.views[0].frustum = {-0.1, 0.12, -0.1, 0.1};
  const Picture left = renderIsosurface(scene, inputs, 0, 12, 12);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 12; ++x) {
      const float distance = left.distance[left.index(x, y)];
      const Ray ray = rayThroughPixel(inputs.views[0], x, y, 12, 12);
      const glm::dvec3 point = ray.origin + ray.direction * (distance / ray.cosine);
      FrameInputs both = inputs;
      both.views.push_back(viewThrough({0.1, 0, 6}, point));
      EXPECT_NEAR(seenOf(renderIsosurface(scene, both, 1, 1, 1)).distance, distance, 2e-5);
    }
}

} // namespace volmark::reference
