#include "volume/mesh/mesh.h"
#include "volume/mesh/voxelise.h"
#include "volume/volume_files.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>

namespace volmark::test {
namespace {

constexpr std::uint64_t kNoLimit = std::uint64_t(1) << 40;

#ifdef VOLMARK_WITH_OPENVDB
#define NEEDS_OPENVDB()
#else
#define NEEDS_OPENVDB() GTEST_SKIP() << "built without OpenVDB"
#endif

class Meshes : public VolumeFiles {
protected:
  /// A tetrahedron, right-handed.
  static std::string tetrahedron() {
    return "OFF\n4 4 0\n0 0 0\n1 0 0 # comment\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3 255 0 0\n3 0 3 2\n3 1 2 3\n";
  }

  /// A sphere around (1, 2, 3) of the radius, as a grid of longitudes and latitudes.
  std::filesystem::path sphere(double radius, int rings) const {
    std::string points;
    std::string faces;
    int pointCount = 0;
    int faceCount = 0;
    const auto point = [&](double theta, double phi) {
      points += fmt::format("{:.9} {:.9} {:.9}\n", 1 + radius * std::sin(theta) * std::cos(phi),
                            2 + radius * std::sin(theta) * std::sin(phi), 3 + radius * std::cos(theta));
      ++pointCount;
    };
    const auto face = [&](std::initializer_list<int> corners) {
      faces += fmt::format("{}", corners.size());
      for (const int corner : corners)
        faces += fmt::format(" {}", corner);
      faces += "\n";
      ++faceCount;
    };
    const double pi = std::numbers::pi;
    const int columns = 2 * rings;
    point(0, 0);
    for (int ring = 1; ring < rings; ++ring)
      for (int column = 0; column < columns; ++column)
        point(pi * ring / rings, 2 * pi * column / columns);
    point(pi, 0);
    const auto at = [&](int ring, int column) { return 1 + (ring - 1) * columns + column % columns; };
    for (int column = 0; column < columns; ++column) {
      face({0, at(1, column), at(1, column + 1)});
      for (int ring = 1; ring + 1 < rings; ++ring)
        face({at(ring, column), at(ring + 1, column), at(ring + 1, column + 1), at(ring, column + 1)});
      face({pointCount - 1, at(rings - 1, column + 1), at(rings - 1, column)});
    }
    return write("sphere.off", fmt::format("OFF\n{} {} 0\n{}{}", pointCount, faceCount, points, faces));
  }
};

TEST_F(Meshes, AreRead) {
  const Mesh mesh = readOff(write("a.off", tetrahedron()), kNoLimit);
  ASSERT_EQ(mesh.points.size(), 4u);
  ASSERT_EQ(mesh.triangles.size(), 4u);
  EXPECT_EQ(mesh.points[3], glm::vec3(0, 0, 1));
  EXPECT_EQ(mesh.triangles[1], glm::uvec3(0, 1, 3));
  requireClosed("a.off", mesh);
}

TEST_F(Meshes, OpenAndTurnedOnesHaveNoInside) {
  Mesh mesh = readOff(write("a.off", tetrahedron()), kNoLimit);
  std::swap(mesh.triangles[2].x, mesh.triangles[2].y);
  expectInputError([&] { requireClosed("a.off", mesh); }, "a.off: 3 edges");
  mesh.triangles.erase(mesh.triangles.begin() + 2);
  expectInputError([&] { requireClosed("a.off", mesh); }, "a.off: 3 edges");
}

TEST_F(Meshes, BadFilesAreOneLine) {
  const std::map<std::string, std::string> lies = {
      {"PLY\n", "not an OFF file: its start: found \"PLY\""},
      {"", "the file ends before \"OFF\""},
      {"OFF\n-4 4 0\n", "number of points: found \"-4\""},
      {"OFF\n4000000000 4 0\n", "number of points: found \"4000000000\""},
      {"OFF\n1 1 0\nnan 0 0\n", "coordinate: found \"nan\""},
      {"OFF\n1 1 0\n0 0 0\n3 0 0 1\n", "corner: found \"1\", allowed: a whole number from 0 to 0"},
      {"OFF\n1 1 0\n0 0 0\n2 0 0\n", "corners of a face: found \"2\""},
      {"OFF\n1 1 0\n0 0 0\n3 0 0", "the file ends before corner"},
  };
  for (const auto& lie : lies)
    expectInputError([&] { readOff(write("lie.off", lie.first), kNoLimit); }, lie.second);
}

class MeshMemory : public Refusals {};

// Sixteen gigabytes of zeros that the header, or a comment, leaves behind it.
TEST_F(MeshMemory, GrowsWithThePoints) {
  const std::uintmax_t length = std::uintmax_t(1) << 34;
  expectInputError([&] { readOff(writeSparse("a.off", "", length), kNoLimit); }, "at most 100 characters");
  expectInputError([&] { readOff(writeSparse("b.off", "OFF\n4 4 0\n", length), kNoLimit); }, "coordinate: found");
  expectInputError([&] { readOff(writeSparse("c.off", "OFF # ", length), kNoLimit); }, "a line of more than 65536");
}

// Whatever character is the first of the second block that is read.
TEST_F(Meshes, WordsMayLieAcrossBlocks) {
  const std::string text = tetrahedron();
  for (std::size_t place = 0; place <= text.size(); ++place) {
    std::string comments;
    for (std::size_t left = 256 * 1024 - place; left > 0; left = 256 * 1024 - place - comments.size())
      comments += std::string(std::min<std::size_t>(left, 60'000) - 1, '#') + "\n";
    const Mesh mesh = readOff(write("a.off", comments + text), kNoLimit);
    ASSERT_EQ(mesh.points.size(), 4u);
    EXPECT_EQ(mesh.points[3], glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.triangles[3], glm::uvec3(1, 2, 3));
  }
}

TEST_F(Meshes, DistancesAreThoseOfASphere) {
  NEEDS_OPENVDB();
  const double radius = 10;
  const MeshSettings settings{64, 16};
  const auto volume = loadMesh(sphere(radius, 100), settings, kNoLimit);
  const Grid& grid = volume->grid();
  EXPECT_EQ(grid.dims, glm::ivec3(64));
  const double spacing = grid.spacingMm.x;
  EXPECT_NEAR(spacing, 2 * radius / (64 - 7), 1e-3);
  std::map<int, double> worst; // by voxels from the surface
  for (int k = 0; k < 64; ++k)
    for (int j = 0; j < 64; ++j)
      for (int i = 0; i < 64; ++i) {
        const double exact = std::clamp(radius - glm::length(grid.toWorld({i, j, k})), -16 * spacing, 16 * spacing);
        double& w = worst[static_cast<int>(std::abs(exact) / spacing)];
        w = std::max(w, std::abs(volume->value(i, j, k) - exact) / spacing);
      }
  // The mesh lies up to radius (1 - cos(pi / 100)) = 0.014 voxels inside the sphere.
  EXPECT_LT(worst[0], 0.02);
  // Further away OpenVDB hands the nearest triangle on from voxel to voxel, which misses the nearest now and then.
  for (const auto& [distance, error] : worst)
    EXPECT_LT(error, 0.5) << distance;
}

TEST_F(Meshes, TheLimitHolds) {
  NEEDS_OPENVDB();
  const auto path = sphere(1, 8);
  expectInputError([&] { loadMesh(path, {256, 16}, 1 << 20); }, "allowed: 1048576 bytes");
  // Also for what was kept under a larger limit.
  ::setenv("VOLMARK_CACHE", (folder() / "cache").c_str(), 1);
  std::filesystem::last_write_time(path, std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
  loadMesh(path, {128, 16}, kNoLimit);
  expectInputError([&] { loadMesh(path, {128, 16}, 1 << 20); }, "allowed: 1048576 bytes");
  ::unsetenv("VOLMARK_CACHE");
}

} // namespace
} // namespace volmark::test
