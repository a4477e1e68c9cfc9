#include "fixture.h"
#include "reference/cell_walk.h"

#include <gtest/gtest.h>

#include <random>

namespace volmark::reference {

namespace {

const Grid kGrid{{3, 5, 9}, {1.0, 2.0, 0.5}}; // a box of 2 x 8 x 4

View randomView(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const glm::dvec3 position = 12.0 * glm::normalize(glm::dvec3(uniform(random), uniform(random), uniform(random)));
  View view = viewFrom(position);
  view.frustum = {-0.3 + 0.1 * uniform(random), 0.3, -0.2, 0.2 + 0.1 * uniform(random)};
  return view;
}

} // namespace

TEST(Path, EntersAndLeavesTheBoxOfVoxelCentres) {
  const auto path = pathThroughPixel(kGrid, {}, viewFrom({0, 0, 10}), 0, 0, 1, 1);
  ASSERT_TRUE(path);
  EXPECT_DOUBLE_EQ(path->entry, 8);
  EXPECT_DOUBLE_EQ(path->exit, 12);
  EXPECT_DOUBLE_EQ(path->cosine, 1);
  EXPECT_EQ(path->entryNormal, glm::dvec3(0, 0, 1));
}

TEST(Path, AgreesWithTheSdkOnPixelCentres) {
  std::mt19937 random(7);
  const Grid huge{{2, 2, 2}, glm::dvec3(1000)};
  for (int i = 0; i < 20; ++i) {
    const View view = randomView(random);
    const auto path = pathThroughPixel(huge, {}, view, i, 3, 20, 11);
    const Ray ray = rayThroughPixel(view, i, 3, 20, 11);
    ASSERT_TRUE(path);
    EXPECT_LT(glm::distance(path->direction, ray.direction), 1e-14);
    EXPECT_NEAR(path->cosine, ray.cosine, 1e-14);
  }
}

TEST(Path, RowZeroIsAtTheTop) {
  const Grid grid{{2, 2, 2}, glm::dvec3(100)};
  EXPECT_GT(pathThroughPixel(grid, {}, viewFrom({0, 0, 10}), 0, 0, 3, 3)->direction.y, 0);
  EXPECT_LT(pathThroughPixel(grid, {}, viewFrom({0, 0, 10}), 0, 0, 3, 3)->direction.x, 0);
}

TEST(Path, OffAxisFrustumShiftsThePicture) {
  // Tangents 0.1 .. 0.3 in x: the middle pixel looks along a tangent of 0.2.
  View view = viewFrom({0, 0, 10});
  view.frustum = {0.1, 0.3, -0.1, 0.1};
  const auto path = pathThroughPixel({{2, 2, 2}, glm::dvec3(50)}, {}, view, 0, 0, 1, 1);
  ASSERT_TRUE(path);
  EXPECT_NEAR(path->direction.x / -path->direction.z, 0.2, 1e-15);
}

TEST(Path, StartsAtTheEyeInsideTheBox) {
  const auto path = pathThroughPixel(kGrid, {}, viewFrom({0, 0, 0.5}), 0, 0, 1, 1);
  ASSERT_TRUE(path);
  EXPECT_EQ(path->entry, 0);
  EXPECT_DOUBLE_EQ(path->exit, 2.5);
  EXPECT_EQ(path->entryNormal, glm::dvec3(0, 0, 1));
}

TEST(Path, MissesWhatIsBehindOrBeside) {
  View away = viewFrom({0, 0, 10});
  away.pose.forward = -away.pose.forward;
  EXPECT_FALSE(pathThroughPixel(kGrid, {}, away, 0, 0, 1, 1));
  View beside = viewFrom({0, 0, 10});
  beside.pose.position.x = 1.001;
  EXPECT_FALSE(pathThroughPixel(kGrid, {}, beside, 0, 0, 1, 1));
}

TEST(Path, ClippingPlanesCutBothEnds) {
  const std::vector<ClippingPlane> planes = {{{0, 0, -2}, -2}, {{0, 0, 1}, -0.5}}; // keeps -0.5 <= z <= 1
  const auto path = pathThroughPixel(kGrid, planes, viewFrom({0, 0, 10}), 0, 0, 1, 1);
  ASSERT_TRUE(path);
  EXPECT_DOUBLE_EQ(path->entry, 9);
  EXPECT_DOUBLE_EQ(path->exit, 10.5);
  EXPECT_EQ(path->entryNormal, glm::dvec3(0, 0, 1));
  const std::vector<ClippingPlane> none = {{{0, 0, 1}, 3}};
  EXPECT_FALSE(pathThroughPixel(kGrid, none, viewFrom({0, 0, 10}), 0, 0, 1, 1));
}

TEST(Path, AxisOfOneVoxelIsSeenAtOnePoint) {
  const Grid plane{{4, 4, 1}, glm::dvec3(1)};
  const auto path = pathThroughPixel(plane, {}, viewFrom({0, 0, 10}), 0, 0, 1, 1);
  ASSERT_TRUE(path);
  EXPECT_EQ(path->entry, path->exit);
  EXPECT_DOUBLE_EQ(path->entry, 10);
}

// Spans join without gaps from entry to exit, and each lies in the cell that it names.
TEST(CellWalk, CoversThePath) {
  const Scene scene = sceneOf(kGrid, [](const glm::dvec3&) { return 0; });
  const Field field(scene, 0);
  std::mt19937 random(3);
  int walks = 0;
  for (int i = 0; i < 500; ++i) {
    const View view = i % 5 == 0 ? viewFrom({12.0 * (i % 2), 0, 12}, {0, 1, 0}) : randomView(random);
    const auto path = pathThroughPixel(kGrid, {}, view, i % 7, i % 3, 7, 3);
    if (!path) continue;
    ++walks;
    CellWalk walk(field, *path);
    CellSpan span;
    double t = path->entry;
    while (walk.next(span)) {
      EXPECT_EQ(span.start, t);
      EXPECT_GE(span.end, span.start);
      for (const auto& [local, at] : {std::pair(span.from, span.start), std::pair(span.to, span.end)}) {
        const glm::dvec3 voxel = field.toVoxel(path->at(at));
        EXPECT_LT(glm::distance(glm::dvec3(span.cell) + local, voxel), 1e-12);
      }
      EXPECT_TRUE(glm::all(glm::greaterThanEqual(span.cell, glm::ivec3(0))));
      EXPECT_TRUE(glm::all(glm::lessThanEqual(span.cell, kGrid.dims - 2)));
      t = span.end;
    }
    EXPECT_EQ(t, path->exit);
  }
  EXPECT_GT(walks, 100);
}

TEST(CellWalk, FollowsCellBoundariesAndDiagonals) {
  const Grid grid{{4, 4, 4}, glm::dvec3(1)};
  const Scene scene = sceneOf(grid, [](const glm::dvec3&) { return 0; });
  const Field field(scene, 0);
  // Along an edge of cells (x and y at voxel 1) and through the corners of three cells.
  const Path edge{{-0.5, -0.5, 5}, {0, 0, -1}, 1, 3.5, 6.5, {0, 0, 1}};
  const Path diagonal{{-3, -3, -3}, glm::normalize(glm::dvec3(1)), 1, 1.5 * std::sqrt(3.0), 4.5 * std::sqrt(3.0), {}};
  for (const Path& path : {edge, diagonal}) {
    CellWalk walk(field, path);
    CellSpan span;
    double length = 0;
    int spans = 0;
    for (; walk.next(span); ++spans) {
      length += span.end - span.start;
      EXPECT_LT(glm::distance(glm::dvec3(span.cell) + span.from, field.toVoxel(path.at(span.start))), 1e-12);
    }
    EXPECT_NEAR(length, path.exit - path.entry, 1e-12);
    EXPECT_LE(spans, 9);
  }
}

} // namespace volmark::reference
