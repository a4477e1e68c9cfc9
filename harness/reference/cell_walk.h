// The cells along a ray, in order and without gaps.
#pragma once

#include "reference/field.h"
#include "reference/path.h"

namespace volmark::reference {

/// The part of a path that lies in one cell.
struct CellSpan {
  glm::ivec3 cell;
  glm::dvec3 from, to; ///< ends in the cell's own coordinates, [0,1]^3
  double start, end;   ///< ends along the path
};

/// Walks a path from cell boundary to cell boundary (Amanatides, Woo: A Fast Voxel Traversal Algorithm for Ray Tracing,
/// 1987). Each boundary's place is computed from its index, so that errors don't add up. There is at least one span;
/// spans may have no length, where a ray passes through a cell's edge.
class CellWalk {
public:
  CellWalk(const Field& field, const Path& path);

  /// False after the last span, which ends at the path's exit.
  bool next(CellSpan& span);

private:
  double crossingOf(int axis) const;
  glm::dvec3 localAt(double t) const;

  glm::ivec3 m_lastCell;
  glm::dvec3 m_origin, m_direction; // in voxels
  glm::ivec3 m_cell;
  glm::dvec3 m_crossing; // where the ray leaves the cell along each axis
  double m_t, m_exit;
  bool m_done = false;
};

} // namespace volmark::reference
