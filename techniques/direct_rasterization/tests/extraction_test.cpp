// What task and mesh shaders extract: counts and list cuts against the CPU model, pictures against the reference.
#include "mesh_shader_isosurface.h"
#include "parts/testing/random_scenes.h"
#include "parts/testing/surface_model.h"
#include "parts/testing/surface_pictures.h"
#include "reference/reference.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace volmark::direct_rasterization {
namespace {

using Values = std::vector<std::pair<std::string, ParameterValue>>;
using parts::Drawn;
using parts::Numbers;
using parts::Session;

constexpr int kWidth = 72;
constexpr int kHeight = 64;

#define REQUIRE_MESH_SHADERS()                                                                                         \
  if (!parts::device().facts().meshShader) GTEST_SKIP() << "no mesh shaders"

struct Case {
  const char* block;
  glm::ivec3 cells;
  std::int64_t vertexLimit;
  glm::ivec3 dims;
  ScalarType type;
};

void expectCounts(const Drawn& drawn, const parts::SurfaceCounts& expected, const std::string& where) {
  EXPECT_EQ(drawn.counters.at("blocks"), expected.blocks) << where;
  EXPECT_EQ(drawn.counters.at("cells"), expected.cells) << where;
  EXPECT_EQ(drawn.counters.at("vertices"), expected.vertices) << where;
  EXPECT_EQ(drawn.counters.at("triangles"), expected.triangles) << where;
  EXPECT_EQ(drawn.counters.at("lists"), expected.lists) << where;
}

TEST(Extraction, CountsAndListCutsEqualTheCpuModel) {
  REQUIRE_MESH_SHADERS();
  const Case cases[] = {{"8x8x4", {8, 8, 4}, 96, {33, 29, 31}, ScalarType::uint8},
                        {"16x4x4", {16, 4, 4}, 32, {40, 18, 9}, ScalarType::int16},
                        {"8x4x4", {8, 4, 4}, 256, {17, 21, 19}, ScalarType::float32},
                        {"4x4x4", {4, 4, 4}, 64, {30, 11, 14}, ScalarType::int8},
                        {"8x8x4", {8, 8, 4}, 48, {9, 9, 5}, ScalarType::uint16},
                        {"8x8x4", {8, 8, 4}, 96, {2, 2, 2}, ScalarType::uint8}};
  Numbers numbers(17);
  for (const Case& c : cases) {
    const auto volume = parts::makeVolume([&](const glm::dvec3&) { return numbers.unit(); }, c.dims, c.type);
    for (const bool noise : {true, false}) {
      const Scene scene = parts::makeScene(noise ? volume : parts::randomVolume(numbers, c.dims, c.type, glm::dvec3(1)),
                                           ShadingModel::none);
      const Values values{{"culling", false},
                          {"block", std::string(c.block)},
                          {"granularity", std::string("block")},
                          {"vertex_limit", c.vertexLimit}};
      Session session(meshShaderIsosurface(), scene, parts::withParameters(meshShaderIsosurface(), values),
                      {kWidth, kHeight, 1});
      const View view = parts::lookAtBox(scene.volume->grid(), 20, 30, kWidth, kHeight);
      for (const double isovalue : {0.5, 0.03, numbers.unit(), 0.0, 1.0}) {
        const Drawn drawn = session.draw(parts::makeInputs(view, isovalue), true);
        expectCounts(drawn, parts::countSurface(scene, isovalue, c.cells, static_cast<int>(c.vertexLimit)),
                     fmt::format("{} {} {} {}", c.block, c.vertexLimit, noise, isovalue));
      }
    }
  }
}

TEST(Extraction, EveryCaseOfACellIsTheTables) {
  REQUIRE_MESH_SHADERS();
  // 256 cells of two voxels in each direction, apart from each other.
  std::vector<std::byte> voxels;
  const glm::ivec3 dims(16 * 4, 16 * 4, 2);
  for (int z = 0; z < dims.z; ++z)
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x) {
        const int inside = x / 4 + 16 * (y / 4);
        const bool isCorner = x % 4 < 2 && y % 4 < 2;
        const int corner = (x % 4) | (y % 4) << 1 | z << 2;
        voxels.push_back(isCorner && (inside >> corner & 1) != 0 ? std::byte{200} : std::byte{0});
      }
  const Scene scene = parts::makeScene(
      std::make_shared<Volume>("cases", Grid{dims, glm::dvec3(1)}, ScalarType::uint8, std::move(voxels)),
      ShadingModel::none);
  for (const double isovalue : {0.5, 1.0}) {
    const FrameInputs inputs =
        parts::makeInputs(parts::lookAtBox(scene.volume->grid(), 10, 20, kWidth, kHeight), isovalue);
    const Drawn drawn =
        parts::drawOnce(meshShaderIsosurface(), scene, inputs, kWidth, kHeight, {{"culling", false}}, true);
    expectCounts(drawn, parts::countSurface(scene, isovalue, {8, 8, 4}, 96), fmt::format("{}", isovalue));
  }
}

TEST(Extraction, AnIsovalueAmongTheVoxelsIsInsideAndOneBeyondThemIsNowhere) {
  REQUIRE_MESH_SHADERS();
  // Voxels 0 to 250 in a range of 0 to 250: the isovalue 100 / 250 is a voxel's own value.
  std::vector<std::byte> voxels;
  const glm::ivec3 dims(26, 26, 26);
  for (int i = 0; i < dims.x * dims.y * dims.z; ++i)
    voxels.push_back(static_cast<std::byte>(10 * (i % 26)));
  Scene scene = parts::makeScene(
      std::make_shared<Volume>("slope", Grid{dims, glm::dvec3(1)}, ScalarType::uint8, std::move(voxels)),
      ShadingModel::none);
  Session session(meshShaderIsosurface(), scene, parts::withParameters(meshShaderIsosurface(), {{"culling", false}}),
                  {kWidth, kHeight, 1});
  const View view = parts::lookAtBox(scene.volume->grid(), -60, 20, kWidth, kHeight);
  for (int voxel = 10; voxel <= 250; voxel += 10) {
    const Drawn drawn = session.draw(parts::makeInputs(view, voxel / 250.0), true);
    expectCounts(drawn, parts::countSurface(scene, voxel / 250.0, {8, 8, 4}, 96), fmt::format("{}", voxel));
    EXPECT_EQ(drawn.counters.at("cells"), 25u * 25u);
  }
  for (const double isovalue : {1.00001, 0.0}) {
    const Drawn drawn = session.draw(parts::makeInputs(view, isovalue), true);
    EXPECT_EQ(drawn.counters.at("blocks"), 0u);
  }
}

TEST(Extraction, MoreBlocksThanARowOfWorkgroups) {
  REQUIRE_MESH_SHADERS();
  // One voxel inside a block of every three: more occupied ones than a dimension of workgroups has to hold.
  const glm::ivec3 dims(1024, 1024, 64);
  std::uint64_t blocks = 0;
  const auto count =
      static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(dims.z);
  std::vector<std::byte> voxels(count);
  for (int z = 2; z < dims.z - 1; z += 4)
    for (int y = 4; y < dims.y - 1; y += 8)
      for (int x = 4 + 8 * ((y / 8 + z / 4) % 3); x < dims.x - 1; x += 24) {
        ++blocks;
        voxels[(static_cast<std::size_t>(z) * static_cast<std::size_t>(dims.y) + static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(dims.x) +
               static_cast<std::size_t>(x)] = std::byte{255};
      }
  ASSERT_GT(blocks, 65535u);
  const Scene scene = parts::makeScene(
      std::make_shared<Volume>("dots", Grid{dims, glm::dvec3(1)}, ScalarType::uint8, std::move(voxels)),
      ShadingModel::none);
  const FrameInputs inputs = parts::makeInputs(parts::lookAtBox(scene.volume->grid(), 10, 20, kWidth, kHeight));
  const Drawn drawn =
      parts::drawOnce(meshShaderIsosurface(), scene, inputs, kWidth, kHeight, {{"culling", false}}, true);
  EXPECT_EQ(drawn.counters.at("blocks"), blocks);
  EXPECT_EQ(drawn.counters.at("cells"), 8 * blocks);
  EXPECT_EQ(drawn.counters.at("triangles"), 8 * blocks);
  EXPECT_EQ(drawn.counters.at("lists"), blocks);
}

class ScalarTypes : public testing::TestWithParam<ScalarType> {};

TEST_P(ScalarTypes, PicturesMatchTheReference) {
  REQUIRE_MESH_SHADERS();
  const Scene scene = parts::makeScene(parts::makeVolume(parts::ripples, {48, 40, 36}, GetParam(), {0.8, 1.1, 1.4}),
                                       ShadingModel::gooch);
  for (const double isovalue : {0.35, 0.6}) {
    const FrameInputs inputs =
        parts::makeInputs(parts::lookAtBox(scene.volume->grid(), 33, 21, kWidth, kHeight), isovalue);
    const Drawn drawn = parts::drawOnce(meshShaderIsosurface(), scene, inputs, kWidth, kHeight, {});
    parts::expectNearReference(drawn.pictures[0], scene, inputs);
  }
}

INSTANTIATE_TEST_SUITE_P(All, ScalarTypes,
                         testing::Values(ScalarType::int8, ScalarType::uint8, ScalarType::int16, ScalarType::uint16,
                                         ScalarType::float32),
                         [](const auto& type) { return std::string(nameOf(type.param)); });

TEST(Extraction, ClippingPlanesAndEyesInsideShowWhatTheReferenceShows) {
  REQUIRE_MESH_SHADERS();
  Scene scene =
      parts::makeScene(parts::makeVolume(parts::ball, glm::ivec3(48), ScalarType::uint16), ShadingModel::lambert);
  FrameInputs inputs = parts::makeInputs(parts::lookAtBox(scene.volume->grid(), 33, 21, kWidth, kHeight), 0.3);
  inputs.light = {.headlight = false, .direction = glm::normalize(glm::dvec3(0.2, 1, 0.4))};
  inputs.clippingPlanes = {{glm::normalize(glm::dvec3(-0.6, -0.3, -1)), -4.0}, {{0, -1, 0}, -10.0}};
  parts::expectNearReference(parts::drawOnce(meshShaderIsosurface(), scene, inputs, kWidth, kHeight, {}).pictures[0],
                             scene, inputs);
  inputs.clippingPlanes.clear();
  // From between the surface and the side of the box, and from inside the solid.
  scene.volume = parts::makeVolume(parts::ripples, glm::ivec3(48), ScalarType::uint16);
  for (const glm::dvec3 eye : {glm::dvec3(20, -20, 20), glm::dvec3(3, 2, -15)}) {
    inputs.views[0] = {.pose = Pose::lookAt(eye, {-3, 1, -2}), .frustum = Frustum::symmetric(60, kWidth, kHeight)};
    for (const double isovalue : {0.3, 0.55}) {
      inputs.isovalue = isovalue;
      parts::expectNearReference(
          parts::drawOnce(meshShaderIsosurface(), scene, inputs, kWidth, kHeight, {}).pictures[0], scene, inputs);
    }
  }
}

TEST(Extraction, PlateausAtTheIsovalueOnSidesOfTheBoxAreSolid) {
  REQUIRE_MESH_SHADERS();
  // Three sides are the isovalue, two voxels deep (where one is, rounding decides what rays see); a corner is above it,
  // all else below.
  const glm::ivec3 dims(24, 20, 22);
  std::vector<std::byte> voxels;
  for (int z = 0; z < dims.z; ++z)
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x) {
        const bool isLevel = x < 2 || z > dims.z - 3 || y < 2;
        voxels.push_back(x + y + z < 6 ? std::byte{255} : isLevel ? std::byte{128} : std::byte{0});
      }
  const Scene scene = parts::makeScene(
      std::make_shared<Volume>("plateaus", Grid{dims, glm::dvec3(1)}, ScalarType::uint8, std::move(voxels)),
      ShadingModel::gooch);
  for (const double azimuth : {-130.0, -40.0, 50.0, 140.0}) {
    const FrameInputs inputs =
        parts::makeInputs(parts::lookAtBox(scene.volume->grid(), azimuth, 21, kWidth, kHeight), 128 / 255.0);
    const Drawn drawn = parts::drawOnce(meshShaderIsosurface(), scene, inputs, kWidth, kHeight, {});
    parts::expectNearReference(drawn.pictures[0], scene, inputs);
  }
}

/// What clipping planes leave of a ray's way through the box.
std::optional<parts::Span> keptSpan(const Grid& grid, const Ray& ray, const std::vector<ClippingPlane>& planes) {
  auto span = parts::boxSpan(grid, ray);
  if (!span) return span;
  for (const ClippingPlane& plane : planes) {
    const double height = glm::dot(plane.normal, ray.origin) - plane.offset;
    const double slope = glm::dot(plane.normal, ray.direction);
    if (slope > 0) span->entry = std::max(span->entry, -height / slope);
    if (slope < 0) span->exit = std::min(span->exit, -height / slope);
  }
  if (span->entry > span->exit) span.reset();
  return span;
}

/// The nearest of the triangles along a ray; infinite if there is none.
double nearestTriangle(const SurfaceMesh& mesh, const Ray& ray) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const glm::uvec3& triangle : mesh.triangles) {
    const glm::dvec3 a = glm::dvec3(mesh.positions[triangle.x]) - ray.origin;
    const glm::dvec3 b = glm::dvec3(mesh.positions[triangle.y]) - ray.origin;
    const glm::dvec3 c = glm::dvec3(mesh.positions[triangle.z]) - ray.origin;
    const double u = glm::dot(ray.direction, glm::cross(b, c)), v = glm::dot(ray.direction, glm::cross(c, a)),
                 w = glm::dot(ray.direction, glm::cross(a, b));
    if ((u < 0) != (v < 0) || (v < 0) != (w < 0)) continue;
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double distance = glm::dot(normal, a) / glm::dot(normal, ray.direction);
    if (distance > 0) nearest = std::min(nearest, distance);
  }
  return nearest;
}

/// How many triangles lie between two points.
int trianglesBetween(const SurfaceMesh& mesh, glm::dvec3 from, const glm::dvec3& to) {
  int count = 0;
  while (glm::length(to - from) > 0) {
    const double distance = nearestTriangle(mesh, {from, glm::normalize(to - from)});
    if (distance >= glm::length(to - from)) break;
    from += (distance + 1e-9) * glm::normalize(to - from);
    ++count;
  }
  return count;
}

TEST(Extraction, SolidsAreClosedWhereRaysEnterThem) {
  REQUIRE_MESH_SHADERS();
  // A cell is many pixels wide, so that a gap between triangles and what closes them would be seen.
  Numbers numbers(53);
  int solid = 0, wrong = 0, hits = 0;
  for (int i = 0; i < 8; ++i) {
    const glm::ivec3 dims(numbers.integer(2, 5), numbers.integer(2, 5), numbers.integer(2, 5));
    const Scene scene = parts::makeScene(
        parts::makeVolume([&](const glm::dvec3&) { return numbers.unit(); }, dims, ScalarType::uint8, {1, 1.2, 0.9}),
        ShadingModel::none);
    const Grid& grid = scene.volume->grid();
    FrameInputs inputs =
        parts::makeInputs(parts::randomView(numbers, grid, kWidth, kHeight), numbers.between(0.2, 0.8));
    if (i % 2 == 1) inputs.clippingPlanes = parts::randomPlanes(numbers, grid);
    const SurfaceMesh mesh = parts::modelSurface(scene, inputs.isovalue);
    const Drawn drawn = parts::drawOnce(meshShaderIsosurface(), scene, inputs, kWidth, kHeight, {});
    const double level = scene.visualisationRange.minimum +
                         inputs.isovalue * (scene.visualisationRange.maximum - scene.visualisationRange.minimum);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const Ray ray = rayThroughPixel(inputs.views[0], x, y, kWidth, kHeight);
        const auto interval = keptSpan(grid, ray, inputs.clippingPlanes);
        double expected = std::numeric_limits<double>::infinity();
        if (interval) {
          const glm::dvec3 entry = ray.origin + interval->entry * ray.direction;
          // The corner of the cell that is far along all axes: the way there lies in no side of it.
          const glm::dvec3 place =
              glm::clamp((entry - grid.boxMinimum()) / grid.spacingMm, glm::dvec3(0), glm::dvec3(dims - 1));
          const glm::ivec3 cell = glm::min(glm::ivec3(place), dims - 2);
          const glm::ivec3 voxel = cell + glm::ivec3(glm::lessThan(place - glm::dvec3(cell), glm::dvec3(0.5)));
          const bool isInside = scene.volume->value(voxel.x, voxel.y, voxel.z) >= level;
          if (isInside != (trianglesBetween(mesh, entry, grid.toWorld(glm::dvec3(voxel))) % 2 == 1)) {
            expected = interval->entry;
            ++solid;
          } else {
            const double nearest = interval->entry + nearestTriangle(mesh, {entry, ray.direction});
            if (nearest <= interval->exit) expected = nearest;
          }
        }
        const float found = drawn.pictures[0].distance[drawn.pictures[0].index(x, y)];
        hits += std::isfinite(expected);
        const bool isAlike =
            std::isfinite(expected) ? std::abs(found - expected * ray.cosine) < 0.02 : std::isinf(found);
        wrong += !isAlike;
      }
  }
  EXPECT_GT(solid, 2000);
  EXPECT_GT(hits, solid + 2000);
  // Pixels on sides of triangles.
  EXPECT_LE(wrong, hits / 500);
}

TEST(Extraction, EyesInTheSolidSeeNothingElseEvenOnDiagonals) {
  REQUIRE_MESH_SHADERS();
  // From the middle of a cell the way to its far corner goes along the diagonal that two triangles share.
  for (int axis = 0; axis < 3; ++axis) {
    const Scene scene =
        parts::makeScene(parts::makeVolume([&](const glm::dvec3& p) { return p[axis] < 0.5 ? 1.0 : 0.0; },
                                           glm::ivec3(4), ScalarType::uint8),
                         ShadingModel::none);
    for (const bool isInside : {true, false}) {
      glm::dvec3 eye(0);
      eye[axis] = isInside ? -0.3 : 0.3;
      glm::dvec3 target(1, 1.3, 1.7);
      FrameInputs inputs = parts::makeInputs(
          {.pose = Pose::lookAt(eye, eye + target), .frustum = Frustum::symmetric(60, kWidth, kHeight)}, 0.5);
      const Drawn drawn = parts::drawOnce(meshShaderIsosurface(), scene, inputs, kWidth, kHeight, {});
      const auto atOnce = std::count_if(drawn.pictures[0].distance.begin(), drawn.pictures[0].distance.end(),
                                        [](float distance) { return distance < 1e-3f; });
      EXPECT_EQ(atOnce, isInside ? kWidth * kHeight : 0) << axis;
    }
  }
}

TEST(Extraction, FlatVolumesHaveNoCells) {
  REQUIRE_MESH_SHADERS();
  const Scene scene =
      parts::makeScene(parts::makeVolume(parts::ball, {40, 40, 1}, ScalarType::uint8), ShadingModel::lambert);
  const FrameInputs inputs = parts::makeInputs(parts::lookAtBox(scene.volume->grid(), 20, 15, kWidth, kHeight), 0.3);
  const Drawn drawn = parts::drawOnce(meshShaderIsosurface(), scene, inputs, kWidth, kHeight, {}, true);
  EXPECT_EQ(drawn.counters.at("triangles"), 0u);
  parts::expectNearReference(drawn.pictures[0], scene, inputs);
}

TEST(Extraction, BothEyesEqualTwoPictures) {
  REQUIRE_MESH_SHADERS();
  const Scene scene =
      parts::makeScene(parts::makeVolume(parts::ripples, glm::ivec3(40), ScalarType::uint16), ShadingModel::gooch);
  FrameInputs inputs = parts::makeInputs(parts::lookAtBox(scene.volume->grid(), 33, 21, kWidth, kHeight));
  View right = inputs.views[0];
  right.pose.position += 6.0 * right.pose.right;
  inputs.views.push_back(right);
  inputs.views[0].layer = 1; // layers need not be in the views' order
  const Drawn both = parts::drawOnce(meshShaderIsosurface(), scene, inputs, kWidth, kHeight, {}, true);
  for (std::size_t view = 0; view < 2; ++view) {
    FrameInputs one = inputs;
    one.views = {inputs.views[view]};
    one.views[0].layer = 0;
    const Drawn single = parts::drawOnce(meshShaderIsosurface(), scene, one, kWidth, kHeight, {}, true);
    EXPECT_TRUE(parts::identical(single.pictures[0], both.pictures[1 - view])) << view;
    // Each extraction serves both.
    EXPECT_LE(both.counters.at("triangles"), parts::countSurface(scene, inputs.isovalue, {8, 8, 4}, 96).triangles);
  }
}

TEST(Extraction, MemoryIsWhatItAddedToTheLedger) {
  REQUIRE_MESH_SHADERS();
  const Scene scene =
      parts::makeScene(parts::makeVolume(parts::ball, glm::ivec3(33), ScalarType::uint8), ShadingModel::gooch);
  for (const bool culling : {false, true}) {
    const Session session(meshShaderIsosurface(), scene,
                          parts::withParameters(meshShaderIsosurface(), {{"culling", culling}}), {kWidth, kHeight, 1});
    std::uint64_t bytes = 0;
    for (const gpu::MemoryItem& item : session.technique().memory())
      bytes += item.bytes;
    EXPECT_EQ(bytes, session.preparedBytes());
  }
}

TEST(Extraction, RefusesWhatCannotBe) {
  REQUIRE_MESH_SHADERS();
  const Scene scene =
      parts::makeScene(parts::makeVolume(parts::ball, glm::ivec3(33), ScalarType::uint8), ShadingModel::gooch);
  const auto why = [&](const Values& values, int views) {
    return meshShaderIsosurface()
        .whyUnsupported(scene, parts::withParameters(meshShaderIsosurface(), values), {kWidth, kHeight, views},
                        &parts::device())
        .value_or("");
  };
  EXPECT_EQ(why({}, 2), "");
  EXPECT_EQ(why({{"block", std::string("16x4x4")}}, 1),
            "granularity: found 8x8x8, allowed: multiples of the block 16x4x4 along each axis, or \"block\".");
  EXPECT_EQ(why({{"block", std::string("16x4x4")}, {"granularity", std::string("16x16x16")}}, 1), "");
  if (parts::device().facts().maximumMeshVertices < 512) {
    EXPECT_THAT(why({{"vertex_limit", std::int64_t(256)}}, 2), testing::StartsWith("vertex_limit: 256 vertices"));
  }
}

} // namespace
} // namespace volmark::direct_rasterization
