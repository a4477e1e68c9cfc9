// The extracted mesh against the CPU model, and its pictures against those of the direct technique.
#include "direct_rasterization/mesh_shader_isosurface.h"
#include "marching_cubes.h"
#include "optimized_mesh.h"
#include "parts/testing/random_scenes.h"
#include "parts/testing/surface_model.h"
#include "parts/testing/surface_pictures.h"
#include "reference/field.h"
#include "volmark/gpu/shader.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

// Written by volmark_embed_shaders() in CMakeLists.txt.
namespace volmark_direct_embedded {
extern const std::vector<volmark::gpu::EmbeddedShader> shaders;
}

namespace volmark::mesh_isosurface {
namespace {

using Values = std::vector<std::pair<std::string, ParameterValue>>;
using parts::Drawn;
using parts::Numbers;
using parts::Session;

constexpr int kWidth = 72;
constexpr int kHeight = 64;

TechniqueFactory directTechnique() {
  static const bool registered = (gpu::registerShaders(volmark_direct_embedded::shaders), true);
  static_cast<void>(registered);
  return direct_rasterization::meshShaderIsosurface();
}

struct Method {
  std::string name;
  TechniqueFactory (*factory)();
  Values values{};
};

void PrintTo(const Method& method, std::ostream* out) {
  *out << method.name;
}

std::vector<Method> methods() {
  return {{"marching_cubes", marchingCubes, {}},
          {"depth_prepass", marchingCubes, {{"depth_prepass", true}}},
          {"meshlets", optimizedMesh, {}},
          {"optimized_indices", optimizedMesh, {{"pipeline", std::string("vertex")}}}};
}

class Meshes : public testing::TestWithParam<Method> {
protected:
  void SetUp() override {
    if (GetParam().name == "meshlets" && !parts::device().facts().meshShader) GTEST_SKIP() << "no mesh shaders";
  }
  Session makeSession(const Scene& scene, int views = 1) const {
    return {GetParam().factory(),
            scene,
            parts::withParameters(GetParam().factory(), GetParam().values),
            {kWidth, kHeight, views}};
  }
};

/// The same vertices in any order, up to rounding.
void expectSamePositions(const SurfaceMesh& found, const SurfaceMesh& expected) {
  using Key = std::array<long, 3>;
  const auto keys = [](const SurfaceMesh& mesh) {
    std::multiset<Key> all;
    for (const glm::vec3& p : mesh.positions)
      all.insert({std::lround(p.x * 1000), std::lround(p.y * 1000), std::lround(p.z * 1000)});
    return all;
  };
  const std::multiset<Key> a = keys(found), b = keys(expected);
  ASSERT_EQ(a.size(), b.size());
  std::vector<Key> alone;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(alone));
  // Some are half-way between two keys.
  EXPECT_LE(alone.size(), a.size() / 50 + 3);
}

/// Sum of all corners of triangles.
glm::dvec3 sumOfCorners(const SurfaceMesh& mesh) {
  glm::dvec3 sum(0);
  for (const glm::uvec3& triangle : mesh.triangles)
    for (int i = 0; i < 3; ++i)
      sum += glm::dvec3(mesh.positions[triangle[i]]);
  return sum;
}

/// Normals are those of the reference's gradient at the positions, where it is steep enough for rounding.
void expectNormalsOfGradient(const SurfaceMesh& mesh, const Scene& scene, const std::string& where) {
  const reference::Field field(scene, 0);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::dvec3 gradient = field.gradient(field.toVoxel(mesh.positions[i]));
    const double steepness = glm::length(gradient);
    if (steepness < 1e-3) continue;
    ASSERT_LT(glm::length(glm::dvec3(mesh.normals[i]) + gradient / steepness), 1e-3) << where << ", vertex " << i;
  }
}

TEST_P(Meshes, AreTheCpuModelsMesh) {
  Numbers numbers(5);
  for (const ScalarType type : {ScalarType::uint8, ScalarType::int16, ScalarType::float32}) {
    const glm::ivec3 dims(numbers.integer(2, 40), numbers.integer(9, 33), numbers.integer(2, 20));
    for (const bool noise : {false, true}) {
      const auto volume =
          noise ? parts::makeVolume([&](const glm::dvec3&) { return numbers.unit(); }, dims, type, {1, 1.3, 0.7})
                : parts::randomVolume(numbers, dims, type, {1, 1.3, 0.7});
      const Scene scene = parts::makeScene(volume, ShadingModel::gooch);
      Session session = makeSession(scene);
      for (const double isovalue : {0.5, 0.2, 0.97}) {
        const std::string where = fmt::format("{} {} {}", nameOf(type), noise, isovalue);
        const Drawn drawn =
            session.draw(parts::makeInputs(parts::lookAtBox(volume->grid(), 20, 30, kWidth, kHeight), isovalue), true);
        const SurfaceMesh expected = parts::modelSurface(scene, isovalue);
        const SurfaceMesh found = session.technique().surface().value();
        EXPECT_EQ(drawn.counters.at("triangles"), found.triangles.size()) << where;
        EXPECT_EQ(drawn.counters.at("vertices"), found.positions.size()) << where;
        ASSERT_EQ(found.normals.size(), found.positions.size()) << where;
        expectNormalsOfGradient(found, scene, where);
        const parts::Topology wanted = parts::topologyOf(expected);
        const parts::Topology is = parts::topologyOf(parts::weldByPosition(found));
        EXPECT_NEAR(is.volume, wanted.volume, 1e-4 * std::abs(wanted.volume) + 1e-3) << where;
        EXPECT_EQ(found.triangles.size(), expected.triangles.size()) << where;
        EXPECT_EQ(is.openSides, wanted.openSides) << where;
        EXPECT_EQ(is.eulerCharacteristic, wanted.eulerCharacteristic) << where;
        expectSamePositions(parts::weldByPosition(found), expected);
      }
    }
  }
}

TEST_P(Meshes, FlatVolumesHaveNoVertices) {
  const Scene scene =
      parts::makeScene(parts::makeVolume(parts::ball, {20, 17, 1}, ScalarType::uint8), ShadingModel::none);
  Session session = makeSession(scene);
  const Drawn drawn =
      session.draw(parts::makeInputs(parts::lookAtBox(scene.volume->grid(), 20, 30, kWidth, kHeight), 0.4), true);
  EXPECT_EQ(drawn.counters.at("vertices"), 0u);
  EXPECT_TRUE(session.technique().surface()->triangles.empty());
}

TEST_P(Meshes, ClosedLevelSetsAreWatertightAcrossBlocks) {
  const auto ring = [](const glm::dvec3& p) {
    const glm::dvec3 q = p - 0.5;
    return std::clamp(1 - 4 * std::hypot(std::hypot(q.x, q.y) - 0.3, q.z), 0.0, 1.0);
  };
  const auto topologyIn = [&](const parts::ScalarField& field, double isovalue) {
    const Scene scene =
        parts::makeScene(parts::makeVolume(field, {45, 41, 43}, ScalarType::float32), ShadingModel::none);
    Session session = makeSession(scene);
    session.draw(parts::makeInputs(parts::lookAtBox(scene.volume->grid(), 20, 30, kWidth, kHeight), isovalue));
    return parts::topologyOf(parts::weldByPosition(session.technique().surface().value()));
  };
  const parts::Topology sphere = topologyIn(parts::ball, 0.4);
  EXPECT_EQ(sphere.openSides, 0u);
  EXPECT_EQ(sphere.eulerCharacteristic, 2);
  EXPECT_GT(sphere.volume, 0);
  const parts::Topology torus = topologyIn(ring, 0.5);
  EXPECT_EQ(torus.openSides, 0u);
  EXPECT_EQ(torus.eulerCharacteristic, 0);
  EXPECT_GT(torus.volume, 0);
}

/// How far pictures of the same triangles by the vertex and the mesh pipeline may be apart: drivers may transform to
/// the viewport in another way, so that the last bits of depth and colour differ.
void expectAlike(const Picture& found, const Picture& expected, bool samePipeline, const std::string& where) {
  if (samePipeline) {
    EXPECT_TRUE(parts::identical(found, expected)) << where << ": " << parts::largestDifference(found, expected);
    EXPECT_TRUE(found.normal == expected.normal) << where;
    return;
  }
  int different = 0;
  for (std::size_t i = 0; i < found.distance.size(); ++i) {
    const float mine = found.distance[i], its = expected.distance[i];
    const bool alike = std::isfinite(mine) ? std::abs(mine - its) <= 1e-5f * its : std::isinf(its);
    if (!alike) ++different;
  }
  // Where two triangles are as near, or a corner snaps to the next place, another one may be seen.
  EXPECT_LE(different, 2) << where;
  EXPECT_LE(parts::meanDifference(found, expected), 1e-5) << where;
}

TEST_P(Meshes, PicturesAreThoseOfTheDirectTechnique) {
  if (!parts::device().facts().meshShader) GTEST_SKIP() << "no mesh shaders";
  Numbers numbers(31);
  for (int i = 0; i < 4; ++i) {
    const Scene scene = parts::makeScene(
        parts::randomVolume(numbers, {47, 38, 41}, i % 2 ? ScalarType::uint16 : ScalarType::uint8, {1, 1.2, 0.9}),
        ShadingModel::gooch);
    Session mine = makeSession(scene, 2);
    Session direct(directTechnique(), scene, parts::withParameters(directTechnique(), {}), {kWidth, kHeight, 2});
    for (int k = 0; k < 6; ++k) {
      FrameInputs inputs = parts::makeInputs(parts::randomView(numbers, scene.volume->grid(), kWidth, kHeight),
                                             numbers.between(0.05, 0.95));
      inputs.clippingPlanes = parts::randomPlanes(numbers, scene.volume->grid());
      View right = inputs.views[0];
      right.pose.position += 2.0 * right.pose.right;
      right.layer = 1;
      inputs.views.push_back(right);
      const Drawn expected = direct.draw(inputs, true);
      const Drawn found = mine.draw(inputs, true);
      for (std::size_t view = 0; view < 2; ++view)
        expectAlike(found.pictures[view], expected.pictures[view], GetParam().name == "meshlets",
                    fmt::format("volume {}, frame {}", i, k));
    }
  }
}

TEST_P(Meshes, GrowWithTheSurfaceAndFollowTimeSteps) {
  // Half of this noise is inside: far more than the first guess of the buffers' sizes; then nothing at all.
  Numbers numbers(3);
  const glm::ivec3 dims(48, 48, 40);
  std::vector<std::byte> voxels;
  for (int i = 0; i < 2 * dims.x * dims.y * dims.z; ++i)
    voxels.push_back(static_cast<std::byte>(numbers.integer(0, 255)));
  const Scene scene = parts::makeScene(
      std::make_shared<Volume>("noise", Grid{dims, glm::dvec3(1)}, ScalarType::uint8, std::move(voxels), 2),
      ShadingModel::lambert);
  Session session = makeSession(scene);
  FrameInputs inputs = parts::makeInputs(parts::lookAtBox(scene.volume->grid(), 20, 30, kWidth, kHeight), 0.999);
  for (const auto& [isovalue, step] : {std::pair(0.999, 0), {0.9, 1}, {0.5, 0}, {1.5, 0}, {0.5, 1}, {0.0, 0}}) {
    inputs.isovalue = isovalue;
    inputs.timeStep = step;
    const Drawn drawn = session.draw(inputs, true);
    const parts::SurfaceCounts expected = parts::countSurface(scene, isovalue, {8, 8, 8}, 1 << 20, step);
    const SurfaceMesh found = session.technique().surface().value();
    EXPECT_EQ(found.triangles.size(), drawn.counters.at("triangles"));
    if (isovalue == 0.9) {
      const glm::dvec3 apart = sumOfCorners(found) - sumOfCorners(parts::modelSurface(scene, isovalue, step));
      EXPECT_LT(glm::length(apart), 1e-4 * static_cast<double>(found.triangles.size()));
    }
    EXPECT_EQ(drawn.counters.at("triangles"), expected.triangles) << isovalue;
    std::uint64_t bytes = 0;
    for (const gpu::MemoryItem& item : session.technique().memory())
      bytes += item.bytes;
    EXPECT_EQ(bytes, session.addedBytes()) << isovalue;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Meshes, testing::ValuesIn(methods()), [](const auto& one) { return one.param.name; });

} // namespace
} // namespace volmark::mesh_isosurface
