#include "image/ssim.h"

#include <cassert>

namespace volmark {

namespace {

constexpr double kDeviation = 1.5;
constexpr double kC1 = 0.01 * 0.01;
constexpr double kC2 = 0.03 * 0.03;

Plane product(const Plane& a, const Plane& b) {
  Plane result(a.width, a.height);
  for (std::size_t i = 0; i < a.values.size(); ++i)
    result.values[i] = a.values[i] * b.values[i];
  return result;
}

} // namespace

Plane ssimMap(const Plane& a, const Plane& b) {
  assert(a.width == b.width && a.height == b.height);
  const Kernel window = gaussianKernel(kDeviation, kSsimWindow / 2);
  const Plane meanA = filterBoth(a, window);
  const Plane meanB = filterBoth(b, window);
  const Plane meanAA = filterBoth(product(a, a), window);
  const Plane meanBB = filterBoth(product(b, b), window);
  const Plane meanAB = filterBoth(product(a, b), window);

  // Equation 13, with the moments of equations 14 to 16.
  Plane map(a.width, a.height);
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    const double ma = meanA.values[i];
    const double mb = meanB.values[i];
    const double varianceA = meanAA.values[i] - ma * ma;
    const double varianceB = meanBB.values[i] - mb * mb;
    const double covariance = meanAB.values[i] - ma * mb;
    map.values[i] =
        (2 * ma * mb + kC1) * (2 * covariance + kC2) / ((ma * ma + mb * mb + kC1) * (varianceA + varianceB + kC2));
  }
  return map;
}

std::optional<double> meanSsim(const Plane& map) {
  constexpr int kMargin = kSsimWindow / 2;
  const int columns = map.width - 2 * kMargin;
  const int rows = map.height - 2 * kMargin;
  if (columns < 1 || rows < 1) return std::nullopt;
  double sum = 0;
  for (int y = kMargin; y < kMargin + rows; ++y)
    for (int x = kMargin; x < kMargin + columns; ++x)
      sum += map.row(y)[x];
  return sum / (double(columns) * rows);
}

} // namespace volmark
