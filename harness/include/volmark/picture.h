// A picture in host memory.
#pragma once

#include <glm/glm.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace volmark {

/// What a picture may have beside colours and distances.
enum class PictureLayer : std::uint8_t {
  normal, ///< where a surface was hit
  steps,  ///< samples, or other turns of the loop, that a pixel's ray took
};

/// Row-major, y down. Equal sizes of all layers; all but `color` may be empty.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<glm::vec4> color;  ///< linear Rec.709, premultiplied alpha
  std::vector<float> distance;   ///< along the view direction, world units; +infinity where nothing is
  std::vector<glm::vec3> normal; ///< unit, in the world; 0 where nothing is or the field has no gradient
  std::vector<float> steps;      ///< of each pixel's ray

  Picture() = default;
  Picture(int columns, int rows)
      : width(columns), height(rows), color(static_cast<std::size_t>(columns) * rows, glm::vec4(0)),
        distance(static_cast<std::size_t>(columns) * rows, HUGE_VALF) {}

  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * width + x; }
};

} // namespace volmark
