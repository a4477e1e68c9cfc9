// A picture in host memory.
#pragma once

#include <glm/glm.hpp>

#include <cmath>
#include <cstddef>
#include <vector>

namespace volmark {

/// Row-major, y down. Equal sizes of all layers; `distance` may be empty (nothing has a surface).
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<glm::vec4> color; ///< linear Rec.709, premultiplied alpha
  std::vector<float> distance;  ///< along the view direction, world units; +infinity where nothing is

  Picture() = default;
  Picture(int columns, int rows)
      : width(columns), height(rows), color(static_cast<std::size_t>(columns) * rows, glm::vec4(0)),
        distance(static_cast<std::size_t>(columns) * rows, HUGE_VALF) {}

  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * width + x; }
};

} // namespace volmark
