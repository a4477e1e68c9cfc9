#include "reference/cell_walk.h"

#include <algorithm>
#include <limits>

namespace volmark::reference {

CellWalk::CellWalk(const Field& field, const Path& path)
    : m_lastCell(glm::max(field.dims() - 2, glm::ivec3(0))), m_origin(field.toVoxel(path.origin)),
      m_direction(field.directionToVoxel(path.direction)), m_t(path.entry), m_exit(path.exit) {
  const glm::dvec3 start = m_origin + m_t * m_direction;
  m_cell = glm::ivec3(glm::clamp(start, glm::dvec3(0), glm::dvec3(m_lastCell)));
  for (int axis = 0; axis < 3; ++axis) {
    // A ray that starts on a boundary belongs to the cell it runs into.
    while ((m_crossing[axis] = crossingOf(axis)) <= m_t)
      m_cell[axis] += m_direction[axis] > 0 ? 1 : -1;
  }
}

double CellWalk::crossingOf(int axis) const {
  // The volume's last cell is left at the path's exit only.
  const double never = std::numeric_limits<double>::infinity();
  const bool ascending = m_direction[axis] > 0;
  if (m_direction[axis] == 0 || m_cell[axis] == (ascending ? m_lastCell[axis] : 0)) return never;
  return (m_cell[axis] + (ascending ? 1 : 0) - m_origin[axis]) / m_direction[axis];
}

glm::dvec3 CellWalk::localAt(double t) const {
  return glm::clamp(m_origin + t * m_direction - glm::dvec3(m_cell), glm::dvec3(0), glm::dvec3(1));
}

bool CellWalk::next(CellSpan& span) {
  if (m_done) return false;
  int axis = m_crossing.x <= m_crossing.y ? 0 : 1;
  if (m_crossing.z < m_crossing[axis]) axis = 2;
  const double end = std::min(m_crossing[axis], m_exit);
  span = {m_cell, localAt(m_t), localAt(end), m_t, end};

  m_done = end == m_exit;
  m_t = end;
  if (!m_done) {
    m_cell[axis] += m_direction[axis] > 0 ? 1 : -1;
    m_crossing[axis] = std::max(crossingOf(axis), m_t);
  }
  return true;
}

} // namespace volmark::reference
