#include "image/plane.h"

#include <algorithm>
#include <cmath>

namespace volmark {

namespace {

/// out[x] += sum over `Count` taps of weights[tap] * taps[tap][x]. Several at once, so that the sums are not stored and
/// loaded for each.
template <int Count>
void addTaps(double* __restrict out, const double* weights, const double* const* taps, int columns) {
  for (int x = 0; x < columns; ++x) {
    double sum = out[x];
    for (int tap = 0; tap < Count; ++tap)
      sum += weights[tap] * taps[tap][x];
    out[x] = sum;
  }
}

void addAllTaps(double* out, const Kernel& kernel, const std::vector<const double*>& taps, int columns) {
  std::size_t tap = 0;
  for (; tap + 4 <= kernel.size(); tap += 4)
    addTaps<4>(out, kernel.data() + tap, taps.data() + tap, columns);
  for (; tap < kernel.size(); ++tap)
    addTaps<1>(out, kernel.data() + tap, taps.data() + tap, columns);
}

int radiusOf(const Kernel& kernel) {
  return static_cast<int>(kernel.size() / 2);
}

} // namespace

Kernel gaussianKernel(double deviation, int radius) {
  Kernel kernel;
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) {
    kernel.push_back(std::exp(-0.5 * i * i / (deviation * deviation)));
    sum += kernel.back();
  }
  for (double& weight : kernel)
    weight /= sum;
  return kernel;
}

Plane filterAlongX(const Plane& plane, const Kernel& kernel) {
  const int radius = radiusOf(kernel);
  Plane result(plane.width, plane.height);
  std::vector<double> padded(static_cast<std::size_t>(plane.width + 2 * radius));
  std::vector<const double*> taps;
  for (std::size_t tap = 0; tap < kernel.size(); ++tap)
    taps.push_back(padded.data() + tap);
  for (int y = 0; y < plane.height; ++y) {
    const double* row = plane.row(y);
    std::fill_n(padded.begin(), radius, row[0]);
    std::copy_n(row, plane.width, padded.begin() + radius);
    std::fill_n(padded.end() - radius, radius, row[plane.width - 1]);
    addAllTaps(result.row(y), kernel, taps, plane.width);
  }
  return result;
}

Plane filterAlongY(const Plane& plane, const Kernel& kernel) {
  const int radius = radiusOf(kernel);
  Plane result(plane.width, plane.height);
  std::vector<const double*> taps(kernel.size());
  for (int y = 0; y < plane.height; ++y) {
    for (int tap = -radius; tap <= radius; ++tap)
      taps[static_cast<std::size_t>(tap + radius)] = plane.row(std::clamp(y + tap, 0, plane.height - 1));
    addAllTaps(result.row(y), kernel, taps, plane.width);
  }
  return result;
}

} // namespace volmark
