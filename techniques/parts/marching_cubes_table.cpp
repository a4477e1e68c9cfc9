#include "parts/marching_cubes_table.h"

#include <cassert>
#include <optional>

namespace volmark::parts {

namespace {

int cornerAt(const glm::ivec3& offset) {
  return offset.x | offset.y << 1 | offset.z << 2;
}

int edgeBetween(int a, int b) {
  const int low = std::min(a, b);
  const glm::ivec3 at = cornerOffset(low);
  switch (a ^ b) {
  case 1: return at.y | at.z << 1;
  case 2: return 4 + (at.x | at.z << 1);
  default: return 8 + (at.x | at.y << 1);
  }
}

/// Corners of a face, counter-clockwise seen from outside of the cell.
std::array<int, 4> cornersOfFace(int axis, int side) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::array<int, 4> corners{};
  for (int i = 0; i < 4; ++i) {
    glm::ivec3 offset(0);
    offset[axis] = side;
    const int turn = side == 1 ? i : 3 - i;
    offset[u] = turn == 1 || turn == 2;
    offset[v] = turn >= 2;
    corners[static_cast<std::size_t>(i)] = cornerAt(offset);
  }
  return corners;
}

/// next[e]: the edge that the loop goes to from edge e, with the inside on its right, seen from outside of the cell:
/// the loop then turns counter-clockwise seen from the outside of the surface.
std::array<int, 12> segmentsOf(int inside) {
  std::array<int, 12> next{};
  next.fill(-1);
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const std::array<int, 4> corners = cornersOfFace(axis, side);
      const auto isInside = [&](int i) { return (inside >> corners[static_cast<std::size_t>(i & 3)] & 1) != 0; };
      const auto edge = [&](int i) {
        return edgeBetween(corners[static_cast<std::size_t>(i & 3)], corners[static_cast<std::size_t>((i + 1) & 3)]);
      };
      // A run of inside corners begins behind edge i, where the walk around the face enters, and ends where it leaves.
      // Every run has a segment of its own: this separates diagonal corners.
      for (int i = 0; i < 4; ++i) {
        if (isInside(i) || !isInside(i + 1)) continue;
        int last = i + 1;
        while (isInside(last + 1))
          ++last;
        next[static_cast<std::size_t>(edge(i))] = edge(last);
      }
    }
  return next;
}

std::array<int, 2> facesOf(int edge) {
  // Faces are numbered 2 * axis + side.
  const int axis = edgeAxis(edge);
  const glm::ivec3 low = lowerEnd(edge);
  const int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
  return {2 * a + low[a], 2 * b + low[b]};
}

bool shareFace(int first, int second) {
  for (const int face : facesOf(first))
    for (const int other : facesOf(second))
      if (face == other) return true;
  return false;
}

/// A fan of the loop. No diagonal may lie in a face of the cell, where the neighbour could have one, too.
std::optional<std::vector<glm::ivec3>> fanOf(const std::vector<int>& loop, std::size_t root) {
  const auto at = [&](std::size_t i) { return loop[(root + i) % loop.size()]; };
  std::vector<glm::ivec3> triangles;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    if (i > 1 && shareFace(at(0), at(i))) return std::nullopt;
    triangles.emplace_back(at(0), at(i), at(i + 1));
  }
  return triangles;
}

CellCase caseOf(int inside) {
  CellCase result;
  const std::array<int, 12> next = segmentsOf(inside);
  for (std::size_t edge = 0; edge < 12; ++edge)
    if (next[edge] >= 0) result.edges |= static_cast<std::uint16_t>(1u << edge);
  std::uint16_t left = result.edges;
  for (int start = 0; start < 12; ++start) {
    if ((left >> start & 1) == 0) continue;
    std::vector<int> loop;
    for (int edge = start; (left >> edge & 1) != 0; edge = next[static_cast<std::size_t>(edge)]) {
      loop.push_back(edge);
      left &= static_cast<std::uint16_t>(~(1u << edge));
    }
    std::optional<std::vector<glm::ivec3>> fan;
    for (std::size_t root = 0; root < loop.size() && !fan; ++root)
      fan = fanOf(loop, root);
    assert(fan);
    result.triangles.insert(result.triangles.end(), fan->begin(), fan->end());
  }
  return result;
}

} // namespace

glm::ivec3 cornerOffset(int corner) {
  return {corner & 1, corner >> 1 & 1, corner >> 2};
}

int edgeAxis(int edge) {
  return edge >> 2;
}

glm::ivec3 lowerEnd(int edge) {
  const int a = edge & 1, b = edge >> 1 & 1;
  switch (edgeAxis(edge)) {
  case 0: return {0, a, b};
  case 1: return {a, 0, b};
  default: return {a, b, 0};
  }
}

const std::array<CellCase, 256>& marchingCubesTable() {
  static const std::array<CellCase, 256> table = [] {
    std::array<CellCase, 256> cases;
    for (int inside = 0; inside < 256; ++inside)
      cases[static_cast<std::size_t>(inside)] = caseOf(inside);
    return cases;
  }();
  return table;
}

std::array<std::uint64_t, 256> packedMarchingCubesTable() {
  std::array<std::uint64_t, 256> packed{};
  for (std::size_t inside = 0; inside < 256; ++inside) {
    const CellCase& cell = marchingCubesTable()[inside];
    std::uint64_t bits = static_cast<std::uint64_t>(cell.triangles.size()) << 60;
    int shift = 0;
    for (const glm::ivec3& triangle : cell.triangles)
      for (int i = 0; i < 3; ++i, shift += 4)
        bits |= static_cast<std::uint64_t>(triangle[i]) << shift;
    packed[inside] = bits;
  }
  return packed;
}

} // namespace volmark::parts
