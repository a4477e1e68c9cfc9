#include "image/ssim.h"

#include <cassert>

namespace volmark {

namespace {

constexpr double kDeviation = 1.5;
constexpr double kC1 = 0.01 * 0.01;
constexpr double kC2 = 0.03 * 0.03;

Plane products(const Plane& a, const Plane& b) {
  Plane result(a.width, a.height);
  for (std::size_t i = 0; i < a.values.size(); ++i)
    result.values[i] = a.values[i] * b.values[i];
  return result;
}

Plane sumsOfSquares(const Plane& a, const Plane& b) {
  Plane result(a.width, a.height);
  for (std::size_t i = 0; i < a.values.size(); ++i)
    result.values[i] = a.values[i] * a.values[i] + b.values[i] * b.values[i];
  return result;
}

} // namespace

Plane ssimMap(const Plane& a, const Plane& b) {
  assert(a.width == b.width && a.height == b.height);
  const Kernel window = gaussianKernel(kDeviation, kSsimWindow / 2);
  const Plane meanA = filterBoth(a, window);
  const Plane meanB = filterBoth(b, window);
  const Plane meanSquares = filterBoth(sumsOfSquares(a, b), window);
  const Plane meanProduct = filterBoth(products(a, b), window);

  // Equation 13, with the moments of equations 14 to 16; of the variances only the sum matters.
  Plane map(a.width, a.height);
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    const double ma = meanA.values[i];
    const double mb = meanB.values[i];
    const double squaredMeans = ma * ma + mb * mb;
    const double variances = meanSquares.values[i] - squaredMeans;
    const double covariance = meanProduct.values[i] - ma * mb;
    map.values[i] = (2 * ma * mb + kC1) * (2 * covariance + kC2) / ((squaredMeans + kC1) * (variances + kC2));
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
