// The triangles of a cell (Lorensen and Cline 1987), for C++ and GLSL (parts/surface.glsl).
//
// Corner c of a cell lies at (c & 1, (c >> 1) & 1, c >> 2). Edge e runs along axis e >> 2; the lower and the higher bit
// of e & 3 are its place along the two other axes, lower axis first. A case has bit c set if corner c is inside.
//
// The rule that makes neighbours agree: what a face shows depends on its four corners alone. Where two diagonal corners
// of a face are inside and two are not, the inside ones are separated. The segments of the six faces form loops, and
// each loop becomes a fan.
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace volmark::parts {

inline constexpr int kMaximumCellTriangles = 5;
inline constexpr int kMaximumCellVertices = 12;

struct CellCase {
  std::uint16_t edges = 0;           ///< a bit for each edge that is crossed; its vertices, in this order
  std::vector<glm::ivec3> triangles; ///< edges; counter-clockwise seen from outside (lower values)
};

/// By case.
const std::array<CellCase, 256>& marchingCubesTable();

glm::ivec3 cornerOffset(int corner);
int edgeAxis(int edge);
/// Offset of the end with the lower coordinate.
glm::ivec3 lowerEnd(int edge);

/// Each case in 16 nibbles: edges of up to five triangles, the number of triangles in the last one.
std::array<std::uint64_t, 256> packedMarchingCubesTable();

} // namespace volmark::parts
