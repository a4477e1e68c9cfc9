// Numbers over the pixels of a picture, and separable filters on them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace volmark {

/// One number a pixel, row-major, y down.
struct Plane {
  int width = 0;
  int height = 0;
  std::vector<double> values;

  Plane() = default;
  Plane(int columns, int rows)
      : width(columns), height(rows), values(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {}

  double* row(int y) { return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); }
  const double* row(int y) const {
    return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }
};

/// Three planes of equal size, such as red, green and blue.
using Planes = std::array<Plane, 3>;

inline Planes makePlanes(int width, int height) {
  return {Plane(width, height), Plane(width, height), Plane(width, height)};
}

/// Weights of 2r+1 neighbours; the middle one is the pixel's own.
using Kernel = std::vector<double>;

/// A Gaussian of standard deviation `deviation` pixels, cut `radius` pixels from the middle, of sum 1.
Kernel gaussianKernel(double deviation, int radius);

/// Correlation along x and along y. Beyond the border counts the nearest pixel.
Plane filterAlongX(const Plane& plane, const Kernel& kernel);
Plane filterAlongY(const Plane& plane, const Kernel& kernel);

/// The same kernel along both.
inline Plane filterBoth(const Plane& plane, const Kernel& kernel) {
  return filterAlongY(filterAlongX(plane, kernel), kernel);
}

} // namespace volmark
