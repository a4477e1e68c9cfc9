#include "image/flip.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace volmark {

namespace {

/// Linear Rec.709 to XYZ, D65, to the nine digits of the authors' own program.
const glm::dmat3 kToXyz = glm::transpose(glm::dmat3(0.412386563, 0.357591491, 0.180450491, // X
                                                    0.212636822, 0.715182982, 0.072180196, // Y
                                                    0.019330620, 0.119197164, 0.950372587));
const glm::dmat3 kToRgb = glm::inverse(kToXyz);
const glm::dvec3 kWhite = kToXyz * glm::dvec3(1);

/// 2020, section 4.1: a linear opponent space; achromatic, red-green, blue-yellow.
glm::dvec3 toOpponent(const glm::dvec3& rgb) {
  const glm::dvec3 xyz = kToXyz * rgb / kWhite;
  return {116 * xyz.y - 16, 500 * (xyz.x - xyz.y), 200 * (xyz.y - xyz.z)};
}

glm::dvec3 fromOpponent(const glm::dvec3& opponent) {
  const double y = (opponent.x + 16) / 116;
  return kToRgb * (glm::dvec3(y + opponent.y / 500, y, y - opponent.z / 200) * kWhite);
}

double labCurve(double share) {
  constexpr double kDelta = 6.0 / 29;
  return share > kDelta * kDelta * kDelta ? std::cbrt(share) : share / (3 * kDelta * kDelta) + 4.0 / 29;
}

/// L*a*b* with chroma weighted by lightness, after Hunt (2020, section 4.1.1).
glm::dvec3 toHuntLab(const glm::dvec3& rgb) {
  const glm::dvec3 xyz = kToXyz * rgb / kWhite;
  const double y = labCurve(xyz.y);
  const double lightness = 116 * y - 16;
  const double weight = 0.01 * lightness;
  return {lightness, weight * 500 * (labCurve(xyz.x) - y), weight * 200 * (y - labCurve(xyz.z))};
}

/// HyAB distance for large colour differences (2020, section 4.1.2).
double hyab(const glm::dvec3& a, const glm::dvec3& b) {
  return std::abs(a.x - b.x) + glm::length(glm::dvec2(a.y - b.y, a.z - b.z));
}

/// 2020, section 4.1.2: differences are compressed, and most of [0,1] is given to those up to `kKnee` of the largest.
class ColorError {
public:
  /// Of linear colours in [0,1].
  double operator()(const glm::dvec3& a, const glm::dvec3& b) const {
    constexpr double kKnee = 0.4;
    constexpr double kAtKnee = 0.95;
    if (a == b) return 0; // most of a background
    const double share = std::pow(hyab(toHuntLab(a), toHuntLab(b)), kExponent) / m_largest;
    return share < kKnee ? kAtKnee * share / kKnee : kAtKnee + (1 - kAtKnee) * (share - kKnee) / (1 - kKnee);
  }

private:
  static constexpr double kExponent = 0.7;
  const double m_largest = std::pow(hyab(toHuntLab({0, 1, 0}), toHuntLab({0, 0, 1})), kExponent);
};

Planes opponentPlanes(const Planes& rgb) {
  Planes result = makePlanes(rgb[0].width, rgb[0].height);
  for (std::size_t i = 0; i < rgb[0].values.size(); ++i) {
    const glm::dvec3 opponent = toOpponent({rgb[0].values[i], rgb[1].values[i], rgb[2].values[i]});
    for (int channel = 0; channel < 3; ++channel)
      result[static_cast<std::size_t>(channel)].values[i] = opponent[channel];
  }
  return result;
}

// Contrast sensitivity (2020, section 4.1.1, table 1): a sum of Gaussians a * sqrt(pi/b) * exp(-pi^2 d^2 / b) over the
// visual angle d in degrees, of sum 1. Achromatic and red-green have one, blue-yellow two.
constexpr double kAchromatic = 0.0047;
constexpr double kRedGreen = 0.0053;
constexpr double kBlueYellow[] = {0.04, 0.025};
constexpr double kBlueYellowHeight[] = {34.1, 13.5};

double deviationOf(double b) {
  return std::sqrt(b / (2 * std::numbers::pi * std::numbers::pi));
}

/// The sum of two 2-D Gaussians is not separable, but each of them is.
Plane filterBlueYellow(const Plane& plane, double pixelsPerDegree, int radius) {
  Plane result(plane.width, plane.height);
  double weights[2];
  Plane filtered[2];
  for (int i = 0; i < 2; ++i) {
    const double deviation = deviationOf(kBlueYellow[i]) * pixelsPerDegree;
    const Kernel kernel = gaussianKernel(deviation, radius);
    filtered[i] = filterBoth(plane, kernel);
    // What the Gaussian sums up to: its height times the square of its 1-D sum, 1 / (largest weight of sum 1).
    const double sum = 1 / kernel[static_cast<std::size_t>(radius)];
    weights[i] = kBlueYellowHeight[i] * std::sqrt(std::numbers::pi / kBlueYellow[i]) * sum * sum;
  }
  const double total = weights[0] + weights[1];
  for (std::size_t i = 0; i < result.values.size(); ++i)
    result.values[i] = (weights[0] * filtered[0].values[i] + weights[1] * filtered[1].values[i]) / total;
  return result;
}

/// What is left of the colours at the viewing distance, linear and clamped.
std::vector<glm::dvec3> perceivedColors(const Planes& opponent, double pixelsPerDegree) {
  const int radius = static_cast<int>(std::ceil(3 * deviationOf(kBlueYellow[0]) * pixelsPerDegree));
  const Plane y = filterBoth(opponent[0], gaussianKernel(deviationOf(kAchromatic) * pixelsPerDegree, radius));
  const Plane cx = filterBoth(opponent[1], gaussianKernel(deviationOf(kRedGreen) * pixelsPerDegree, radius));
  const Plane cz = filterBlueYellow(opponent[2], pixelsPerDegree, radius);
  std::vector<glm::dvec3> result(y.values.size());
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = glm::clamp(fromOpponent({y.values[i], cx.values[i], cz.values[i]}), 0.0, 1.0);
  return result;
}

/// Positive weights sum to 1, negative ones to -1.
void balance(Kernel& kernel) {
  double positive = 0;
  double negative = 0;
  for (const double weight : kernel)
    (weight > 0 ? positive : negative) += weight;
  for (double& weight : kernel)
    weight /= weight > 0 ? positive : -negative;
}

/// How strong edges and points are (2020, section 4.2): lengths of the first and of the second derivatives.
struct Features {
  Plane edges;
  Plane points;
};

Plane lengths(const Plane& x, const Plane& y) {
  Plane result(x.width, x.height);
  for (std::size_t i = 0; i < result.values.size(); ++i)
    result.values[i] = std::sqrt(x.values[i] * x.values[i] + y.values[i] * y.values[i]);
  return result;
}

Features detectFeatures(const Plane& achromatic, double pixelsPerDegree) {
  // The width of the human edge detector in degrees, and how many deviations are in it.
  const double deviation = 0.5 * 0.082 * pixelsPerDegree;
  const int radius = static_cast<int>(std::ceil(3 * deviation));
  const Kernel smooth = gaussianKernel(deviation, radius);
  Kernel first = smooth;
  Kernel second = smooth;
  for (int i = -radius; i <= radius; ++i) {
    const auto tap = static_cast<std::size_t>(i + radius);
    first[tap] *= -i;
    second[tap] *= i * i / (deviation * deviation) - 1;
  }
  balance(first);
  balance(second);

  const Plane smoothX = filterAlongX(achromatic, smooth);
  const Plane smoothY = filterAlongY(achromatic, smooth);
  return {lengths(filterAlongX(smoothY, first), filterAlongY(smoothX, first)),
          lengths(filterAlongX(smoothY, second), filterAlongY(smoothX, second))};
}

/// The achromatic channel in [0,1].
Plane normalised(Plane achromatic) {
  for (double& value : achromatic.values)
    value = (value + 16) / 116;
  return achromatic;
}

/// A fit to the ACES film curve: (a x^2 + b x) / (c x^2 + d x + e), with its exposure of 0.6 undone (2021, table 1).
struct ToneCurve {
  double a = 0.6 * 0.6 * 2.51;
  double b = 0.6 * 0.03;
  double c = 0.6 * 0.6 * 2.43;
  double d = 0.6 * 0.59;
  double e = 0.14;

  double operator()(double x) const {
    // Very bright values overflow to no number.
    if (x > 1e6) return 1;
    return std::clamp((a * x * x + b * x) / (c * x * x + d * x + e), 0.0, 1.0);
  }
  /// Where the curve reaches `t`.
  double inverse(double t) const {
    const double p = (b - d * t) / (a - c * t);
    const double q = -e * t / (a - c * t);
    return -p / 2 + std::sqrt(p * p / 4 - q);
  }
};

Planes toneMapped(const Planes& linear, double exposure) {
  const ToneCurve curve;
  const double gain = std::exp2(exposure);
  Planes result = linear;
  for (Plane& plane : result)
    for (double& value : plane.values)
      value = curve(gain * std::max(value, 0.0));
  return result;
}

} // namespace

Plane flipMap(const Planes& picture, const Planes& reference, double pixelsPerDegree) {
  assert(picture[0].width == reference[0].width && picture[0].height == reference[0].height);
  const Planes opponent[] = {opponentPlanes(picture), opponentPlanes(reference)};
  const std::vector<glm::dvec3> colors[] = {perceivedColors(opponent[0], pixelsPerDegree),
                                            perceivedColors(opponent[1], pixelsPerDegree)};
  const Features features[] = {detectFeatures(normalised(opponent[0][0]), pixelsPerDegree),
                               detectFeatures(normalised(opponent[1][0]), pixelsPerDegree)};

  // 2020, equations 12 to 14: a difference of features amplifies that of colours.
  const ColorError colorError;
  Plane map(picture[0].width, picture[0].height);
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    const double edges = std::abs(features[0].edges.values[i] - features[1].edges.values[i]);
    const double points = std::abs(features[0].points.values[i] - features[1].points.values[i]);
    const double featureError = std::sqrt(std::max(edges, points) / std::numbers::sqrt2);
    map.values[i] = std::pow(colorError(colors[0][i], colors[1][i]), 1 - featureError);
  }
  return map;
}

std::vector<double> flipExposures(const Planes& reference) {
  std::vector<double> luminances;
  for (std::size_t i = 0; i < reference[0].values.size(); ++i) {
    const double luminance = 0.2126 * std::max(reference[0].values[i], 0.0) +
                             0.7152 * std::max(reference[1].values[i], 0.0) +
                             0.0722 * std::max(reference[2].values[i], 0.0);
    if (std::isfinite(luminance)) luminances.push_back(luminance);
  }
  std::sort(luminances.begin(), luminances.end());
  if (luminances.empty() || luminances.back() <= 0) return {0};
  auto first = luminances.begin();
  if (luminances[luminances.size() / 2] <= 0) first = std::upper_bound(first, luminances.end(), 0.0);
  const double median = *(first + (luminances.end() - first) / 2);

  const double target = ToneCurve().inverse(0.85);
  const double start = std::log2(target / luminances.back());
  const double stop = std::log2(target / median);
  const int count = std::max(2, static_cast<int>(std::ceil(stop - start)));
  std::vector<double> exposures;
  for (int i = 0; i < count; ++i)
    exposures.push_back(start + i * (stop - start) / (count - 1));
  return exposures;
}

Plane hdrFlipMap(const Planes& picture, const Planes& reference, double pixelsPerDegree) {
  Plane largest(picture[0].width, picture[0].height);
  for (const double exposure : flipExposures(reference)) {
    const Plane map = flipMap(toneMapped(picture, exposure), toneMapped(reference, exposure), pixelsPerDegree);
    for (std::size_t i = 0; i < largest.values.size(); ++i)
      largest.values[i] = std::max(largest.values[i], map.values[i]);
  }
  return largest;
}

} // namespace volmark
