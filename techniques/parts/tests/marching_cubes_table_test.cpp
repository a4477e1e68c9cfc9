// The table of marching cubes: neighbours agree on every face, and all cases are closed and turned outward.
#include "parts/marching_cubes_table.h"

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <set>
#include <utility>

namespace volmark::parts {
namespace {

using Segment = std::pair<int, int>; // from edge to edge

/// Sides of triangles that have no opposite: where the surface leaves the cell.
std::set<Segment> boundaryOf(const CellCase& cell) {
  std::map<Segment, int> sides;
  for (const glm::ivec3& triangle : cell.triangles)
    for (int i = 0; i < 3; ++i)
      ++sides[{triangle[i], triangle[(i + 1) % 3]}];
  std::set<Segment> boundary;
  for (const auto& [side, count] : sides) {
    EXPECT_EQ(count, 1);
    if (!sides.contains({side.second, side.first})) boundary.insert(side);
  }
  return boundary;
}

/// Whether an edge lies in the face across `axis` at `side`.
bool isOnFace(int edge, int axis, int side) {
  return edgeAxis(edge) != axis && lowerEnd(edge)[axis] == side;
}

/// The edge of the neighbour across `axis` that is the same: from side 1 to side 0.
int mirrored(int edge, int axis) {
  glm::ivec3 low = lowerEnd(edge);
  low[axis] = 0;
  for (int other = 0; other < 12; ++other)
    if (edgeAxis(other) == edgeAxis(edge) && lowerEnd(other) == low) return other;
  return -1;
}

std::set<Segment> segmentsOn(int inside, int axis, int side) {
  std::set<Segment> segments;
  for (const Segment& segment : boundaryOf(marchingCubesTable()[static_cast<std::size_t>(inside)]))
    if (isOnFace(segment.first, axis, side) && isOnFace(segment.second, axis, side)) segments.insert(segment);
  return segments;
}

/// The corners of a face as bits, in the order of their coordinates.
int cornersOn(int inside, int axis, int side) {
  int bits = 0, place = 0;
  for (int corner = 0; corner < 8; ++corner)
    if (cornerOffset(corner)[axis] == side) bits |= (inside >> corner & 1) << place++;
  return bits;
}

TEST(MarchingCubesTable, VerticesAreTheEdgesThatTheSurfaceCrosses) {
  for (int inside = 0; inside < 256; ++inside) {
    const CellCase& cell = marchingCubesTable()[static_cast<std::size_t>(inside)];
    std::uint16_t used = 0;
    for (const glm::ivec3& triangle : cell.triangles)
      for (int i = 0; i < 3; ++i)
        used |= static_cast<std::uint16_t>(1u << triangle[i]);
    for (int edge = 0; edge < 12; ++edge) {
      glm::ivec3 end = lowerEnd(edge);
      const int a = end.x | end.y << 1 | end.z << 2;
      end[edgeAxis(edge)] = 1;
      const int b = end.x | end.y << 1 | end.z << 2;
      EXPECT_EQ(cell.edges >> edge & 1, (inside >> a & 1) != (inside >> b & 1)) << inside << " " << edge;
    }
    EXPECT_EQ(used, cell.edges) << inside;
    EXPECT_LE(cell.triangles.size(), static_cast<std::size_t>(kMaximumCellTriangles));
    // What meshes of so many vertices reserve for triangles.
    EXPECT_LE(7 * cell.triangles.size(), 5u * static_cast<unsigned>(std::popcount(cell.edges)));
  }
}

TEST(MarchingCubesTable, TheSurfaceLeavesACellThroughItsFacesAlone) {
  for (int inside = 0; inside < 256; ++inside)
    for (const Segment& segment : boundaryOf(marchingCubesTable()[static_cast<std::size_t>(inside)])) {
      bool onAFace = false;
      for (int face = 0; face < 6; ++face)
        onAFace |= isOnFace(segment.first, face / 2, face % 2) && isOnFace(segment.second, face / 2, face % 2);
      EXPECT_TRUE(onAFace) << inside;
    }
}

TEST(MarchingCubesTable, NeighboursAgreeOnEveryFace) {
  for (int axis = 0; axis < 3; ++axis) {
    std::map<int, std::set<Segment>> byCorners; // of side 1, seen as the neighbour's side 0
    for (int inside = 0; inside < 256; ++inside) {
      std::set<Segment> mine;
      for (const Segment& segment : segmentsOn(inside, axis, 1))
        mine.insert({mirrored(segment.second, axis), mirrored(segment.first, axis)});
      const auto [found, isNew] = byCorners.try_emplace(cornersOn(inside, axis, 1), mine);
      EXPECT_EQ(found->second, mine) << "the same corners show another face: " << inside;
    }
    for (int inside = 0; inside < 256; ++inside)
      EXPECT_EQ(segmentsOn(inside, axis, 0), byCorners.at(cornersOn(inside, axis, 0))) << inside;
  }
}

TEST(MarchingCubesTable, DiagonalCornersOfAFaceAreSeparated) {
  // Corners 0 and 3 lie across the face z = 0: each is cut off by a segment of its own.
  const std::set<Segment> segments = segmentsOn(0b1001, 2, 0);
  EXPECT_EQ(segments.size(), 2u);
  for (const Segment& segment : segments) {
    const std::set<int> edges = {segment.first, segment.second};
    EXPECT_TRUE(edges == (std::set<int>{0, 4}) || edges == (std::set<int>{1, 5}));
  }
}

TEST(MarchingCubesTable, TrianglesFaceLowerValues) {
  for (int inside = 1; inside < 255; ++inside) {
    // The volume below the triangles and the inside corners' share of the faces: with edges cut near their inside ends,
    // every triangle sees its nearest inside corner behind it.
    const CellCase& cell = marchingCubesTable()[static_cast<std::size_t>(inside)];
    const auto vertex = [&](int edge) {
      glm::dvec3 a(lowerEnd(edge)), b = a;
      b[edgeAxis(edge)] = 1;
      const int corner = lowerEnd(edge).x | lowerEnd(edge).y << 1 | lowerEnd(edge).z << 2;
      return (inside >> corner & 1) != 0 ? glm::mix(a, b, 0.1) : glm::mix(a, b, 0.9);
    };
    double outward = 0;
    for (const glm::ivec3& triangle : cell.triangles) {
      const glm::dvec3 a = vertex(triangle.x), b = vertex(triangle.y), c = vertex(triangle.z);
      const glm::dvec3 normal = glm::cross(b - a, c - a);
      for (int i = 0; i < 3; ++i) {
        // Along its edge, from the inside end to the outside one.
        glm::dvec3 direction(0);
        const int edge = triangle[i];
        const int corner = lowerEnd(edge).x | lowerEnd(edge).y << 1 | lowerEnd(edge).z << 2;
        direction[edgeAxis(edge)] = (inside >> corner & 1) != 0 ? 1 : -1;
        outward += glm::dot(normal, direction);
      }
    }
    EXPECT_GT(outward, 0) << inside;
  }
}

TEST(MarchingCubesTable, PackedCasesAreTheTable) {
  const auto packed = packedMarchingCubesTable();
  for (std::size_t inside = 0; inside < 256; ++inside) {
    const CellCase& cell = marchingCubesTable()[inside];
    ASSERT_EQ(packed[inside] >> 60, cell.triangles.size());
    for (std::size_t i = 0; i < cell.triangles.size(); ++i)
      for (int k = 0; k < 3; ++k)
        ASSERT_EQ(static_cast<int>(packed[inside] >> (12 * i + 4 * static_cast<std::size_t>(k)) & 15),
                  cell.triangles[i][k]);
  }
}

} // namespace
} // namespace volmark::parts
