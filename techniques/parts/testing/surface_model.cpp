#include "parts/testing/surface_model.h"

#include "parts/marching_cubes_table.h"
#include "parts/surface_shared.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <unordered_map>

namespace volmark::parts {

namespace {

/// One time step, asked whether voxels are inside.
class Field {
public:
  Field(const Scene& scene, double isovalue, int timeStep) : m_volume(*scene.volume), m_timeStep(timeStep) {
    const Range& range = scene.visualisationRange;
    m_level = range.minimum + isovalue * (range.maximum - range.minimum);
    m_allInside = isovalue <= 0;
    m_noneInside = isovalue > 1;
  }
  double value(const glm::ivec3& voxel) const { return m_volume.value(voxel.x, voxel.y, voxel.z, m_timeStep); }
  bool isInside(const glm::ivec3& voxel) const { return !m_noneInside && (m_allInside || value(voxel) >= m_level); }
  int caseOf(const glm::ivec3& cell) const {
    int corners = 0;
    for (int corner = 0; corner < 8; ++corner)
      corners |= int(isInside(cell + cornerOffset(corner))) << corner;
    return corners;
  }
  double level() const { return m_level; }

private:
  const Volume& m_volume;
  int m_timeStep;
  double m_level;
  bool m_allInside;
  bool m_noneInside;
};

template <class Visit> void forBox(const glm::ivec3& low, const glm::ivec3& end, Visit visit) {
  for (int z = low.z; z < end.z; ++z)
    for (int y = low.y; y < end.y; ++y)
      for (int x = low.x; x < end.x; ++x)
        visit(glm::ivec3(x, y, z));
}

using Bits = std::array<std::uint32_t, 3>;

Bits bitsOf(const glm::vec3& position) {
  // Both zeros are one place.
  return {std::bit_cast<std::uint32_t>(position.x + 0.0f), std::bit_cast<std::uint32_t>(position.y + 0.0f),
          std::bit_cast<std::uint32_t>(position.z + 0.0f)};
}

} // namespace

SurfaceCounts countSurface(const Scene& scene, double isovalue, const glm::ivec3& block, int vertexLimit,
                           int timeStep) {
  const Field field(scene, isovalue, timeStep);
  const glm::ivec3 cells = scene.volume->grid().dims - 1;
  SurfaceCounts counts;
  forBox(glm::ivec3(0), (cells + block - 1) / block, [&](glm::ivec3 place) {
    const glm::ivec3 low = place * block;
    int listCells = 0, listVertices = 0;
    bool occupied = false;
    forBox(low, glm::min(low + block, cells), [&](glm::ivec3 cell) {
      const CellCase& found = marchingCubesTable()[static_cast<std::size_t>(field.caseOf(cell))];
      if (found.edges == 0) return;
      const int vertices = std::popcount(found.edges);
      if (listCells == 0 || listCells == 32 || listVertices + vertices > vertexLimit) {
        ++counts.lists;
        listCells = listVertices = 0;
      }
      ++listCells;
      listVertices += vertices;
      occupied = true;
      ++counts.cells;
      counts.vertices += static_cast<std::uint64_t>(vertices);
      counts.triangles += found.triangles.size();
    });
    if (occupied) ++counts.blocks;
  });
  return counts;
}

SurfaceMesh modelSurface(const Scene& scene, double isovalue, int timeStep) {
  const Field field(scene, isovalue, timeStep);
  const Grid& grid = scene.volume->grid();
  SurfaceMesh mesh;
  std::unordered_map<std::uint64_t, glm::uint> vertices; // by edge: voxel and axis
  const auto vertexOf = [&](const glm::ivec3& cell, int edge) {
    const glm::ivec3 low = cell + lowerEnd(edge);
    const auto voxel =
        (static_cast<std::uint64_t>(low.z) * static_cast<unsigned>(grid.dims.y) + static_cast<unsigned>(low.y)) *
            static_cast<unsigned>(grid.dims.x) +
        static_cast<unsigned>(low.x);
    const auto [found, isNew] = vertices.try_emplace(3 * voxel + static_cast<unsigned>(edgeAxis(edge)),
                                                     static_cast<glm::uint>(mesh.positions.size()));
    if (isNew) {
      glm::ivec3 high = low;
      ++high[edgeAxis(edge)];
      const double a = field.value(low), b = field.value(high);
      glm::dvec3 place(low);
      place[edgeAxis(edge)] += std::clamp<double>((field.level() - a) / (b - a), kEdgeMargin, 1.0 - kEdgeMargin);
      mesh.positions.emplace_back(grid.toWorld(place));
    }
    return found->second;
  };
  forBox(glm::ivec3(0), grid.dims - 1, [&](glm::ivec3 cell) {
    for (const glm::ivec3& edges : marchingCubesTable()[static_cast<std::size_t>(field.caseOf(cell))].triangles)
      mesh.triangles.emplace_back(vertexOf(cell, edges.x), vertexOf(cell, edges.y), vertexOf(cell, edges.z));
  });
  return mesh;
}

SurfaceMesh weldByPosition(const SurfaceMesh& mesh) {
  SurfaceMesh welded;
  std::map<Bits, glm::uint> places;
  std::vector<glm::uint> indices;
  for (const glm::vec3& position : mesh.positions) {
    const auto [found, isNew] = places.try_emplace(bitsOf(position), static_cast<glm::uint>(welded.positions.size()));
    if (isNew) welded.positions.push_back(position);
    indices.push_back(found->second);
  }
  for (const glm::uvec3& triangle : mesh.triangles) {
    const glm::uvec3 corners(indices[triangle.x], indices[triangle.y], indices[triangle.z]);
    if (corners.x != corners.y && corners.y != corners.z && corners.z != corners.x) welded.triangles.push_back(corners);
  }
  return welded;
}

Topology topologyOf(const SurfaceMesh& mesh) {
  std::map<std::pair<glm::uint, glm::uint>, std::int64_t> sides;
  Topology topology;
  for (const glm::uvec3& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i)
      ++sides[{triangle[i], triangle[(i + 1) % 3]}];
    const glm::dvec3 a(mesh.positions[triangle.x]), b(mesh.positions[triangle.y]), c(mesh.positions[triangle.z]);
    topology.volume += glm::dot(a, glm::cross(b, c)) / 6;
  }
  std::int64_t edges = 0;
  for (const auto& [side, count] : sides) {
    const auto back = sides.find({side.second, side.first});
    const std::int64_t opposite = back == sides.end() ? 0 : back->second;
    if (opposite != count) ++topology.openSides;
    if (opposite == 0 || side.first < side.second) edges += std::max(count, opposite);
  }
  topology.eulerCharacteristic =
      static_cast<std::int64_t>(mesh.positions.size()) - edges + static_cast<std::int64_t>(mesh.triangles.size());
  return topology;
}

} // namespace volmark::parts
