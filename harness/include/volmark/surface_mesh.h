// A triangle mesh of an isosurface.
#pragma once

#include <glm/glm.hpp>

#include <vector>

namespace volmark {

struct SurfaceMesh {
  std::vector<glm::vec3> positions; ///< world space, mm
  std::vector<glm::vec3>
      normals; ///< unit, towards lower values; 0 where the field has no gradient; as many as positions
  std::vector<glm::uvec3> triangles; ///< counter-clockwise seen from lower values
};

} // namespace volmark
