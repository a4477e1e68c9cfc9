#include "reference/medium.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace volmark::reference {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

glm::dvec4 between(const glm::dvec4& a, const glm::dvec4& b, double share) {
  return a + (b - a) * share;
}

/// The mean of -ln(1 - opacity) while the opacity runs linearly from a to b.
double meanExtinction(double a, double b) {
  const double p = 1 - a;
  const double q = 1 - b;
  const double middle = 0.5 * (p + q);
  const double difference = p - q;
  // The closed form cancels for nearly equal ends: expand about the middle there.
  if (std::abs(difference) < 1e-3 * middle) return -std::log(middle) + difference * difference / (24 * middle * middle);
  return 1 - (p * std::log(p) - q * std::log(q)) / difference;
}

/// Where in the portion (0 front, 1 back) the light that leaves its front comes from, on average: the integral of s
/// dA(s) over A(1), with A(s) the opacity of the part before s; by parts, 1 minus the integral of A(s) / A(1).
double meanOrigin(double frontOpacity, double backOpacity, double lengthVoxels, double depth) {
  // Gauss-Legendre, four nodes a part.
  constexpr std::array<double, 4> kNodes = {0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                            0.93056815579702629};
  constexpr std::array<double, 4> kWeights = {0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
                                              0.17392742256872693};
  const int parts = 2 + static_cast<int>(std::min(depth, 100.0));
  double integral = 0;
  for (int part = 0; part < parts; ++part) {
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
      // Nodes gather quadratically at the more opaque end, where the extinction rises steeply.
      const double u = (part + kNodes[i]) / parts;
      const double s = backOpacity > frontOpacity ? u * (2 - u) : u * u;
      const double ds = 2 * (backOpacity > frontOpacity ? 1 - u : u) * kWeights[i] / parts;
      const double opacityAtNode = frontOpacity + (backOpacity - frontOpacity) * s;
      integral -= ds * std::expm1(-lengthVoxels * s * meanExtinction(frontOpacity, opacityAtNode));
    }
  }
  return 1 + integral / std::expm1(-depth);
}

/// The function by its control points: the later of two equal values holds from there on; constant outside.
glm::dvec4 atPoints(const std::vector<ControlPoint>& points, double value) {
  const auto whole = [](const ControlPoint& point) { return glm::dvec4(point.color, point.opacity); };
  std::size_t above = 0;
  while (above < points.size() && points[above].value <= value)
    ++above;
  if (above == 0) return whole(points.front());
  if (above == points.size()) return whole(points.back());
  const ControlPoint& low = points[above - 1];
  return between(whole(low), whole(points[above]), (value - low.value) / (points[above].value - low.value));
}

glm::dvec4 capped(glm::dvec4 colorAndOpacity) {
  colorAndOpacity.a = std::min(colorAndOpacity.a, kMaximumOpacity);
  return colorAndOpacity;
}

} // namespace

glm::dvec4 Medium::Piece::at(double value) const {
  if (std::isinf(low) || std::isinf(high)) return atLow;
  return between(atLow, atHigh, (value - low) / (high - low));
}

Medium::Medium(const TransferFunction& function) {
  // Beyond [0,1] the scalar is clamped: constant pieces there.
  std::vector<ControlPoint> points = function.points();
  assert(!points.empty());
  const glm::dvec4 atZero = capped(atPoints(points, 0));
  const glm::dvec4 atOne = capped(atPoints(points, 1));
  points.insert(points.begin(), points.front());
  points.front().value = std::min(points.front().value, 0.0);
  points.push_back(points.back());
  points.back().value = std::max(points.back().value, 1.0);

  m_pieces.push_back({-kInfinity, 0, atZero, atZero});
  for (std::size_t i = 1; i < points.size(); ++i) {
    const ControlPoint& a = points[i - 1];
    const ControlPoint& b = points[i];
    addPiece({a.value, b.value, glm::dvec4(a.color, a.opacity), glm::dvec4(b.color, b.opacity)});
  }
  m_pieces.push_back({1, kInfinity, atOne, atOne});
  for (std::size_t i = 1; i < m_pieces.size(); ++i)
    m_bends.push_back(m_pieces[i].low);
}

void Medium::addPiece(Piece piece) {
  // Clip to [0,1].
  const double low = std::max(piece.low, 0.0);
  const double high = std::min(piece.high, 1.0);
  if (low >= high) return;
  piece = {low, high, piece.at(low), piece.at(high)};

  // Split where the opacity reaches its cap, then cap both parts.
  const double rise = piece.atHigh.a - piece.atLow.a;
  const double reach = rise != 0 ? (kMaximumOpacity - piece.atLow.a) / rise : 0;
  const double middle = low + reach * (high - low);
  if (reach > 0 && reach < 1 && middle > low && middle < high) {
    const glm::dvec4 atMiddle = capped(piece.at(middle));
    m_pieces.push_back({low, middle, capped(piece.atLow), atMiddle});
    m_pieces.push_back({middle, high, atMiddle, capped(piece.atHigh)});
  } else {
    m_pieces.push_back({low, high, capped(piece.atLow), capped(piece.atHigh)});
  }
}

std::size_t Medium::indexOf(double value) const {
  const auto next = std::upper_bound(m_pieces.begin(), m_pieces.end(), value,
                                     [](double v, const Piece& piece) { return v < piece.low; });
  return static_cast<std::size_t>(next - m_pieces.begin()) - 1;
}

glm::dvec4 Medium::evaluate(double value) const {
  return m_pieces[indexOf(value)].at(value);
}

bool Medium::isTransparent(double low, double high) const {
  const std::size_t last = indexOf(high);
  for (std::size_t i = indexOf(low); i <= last; ++i) {
    const Piece& piece = m_pieces[i];
    if (piece.at(std::max(low, piece.low)).a > 0 || piece.at(std::min(high, piece.high)).a > 0) return false;
  }
  return true;
}

glm::dvec4 Medium::slab(double front, double back, double lengthVoxels) const {
  glm::dvec3 color(0);
  double transmittance = 1;
  std::size_t index = indexOf(front);
  for (double from = front;;) {
    // The portion of the slab that lies in one piece of the function.
    const Piece& piece = m_pieces[index];
    const double to = back >= front ? std::min(back, piece.high) : std::max(back, piece.low);
    const double length = back == front ? lengthVoxels : lengthVoxels * (to - from) / (back - front);
    const glm::dvec4 a = piece.at(from);
    const glm::dvec4 b = piece.at(to);
    if (length > 0 && (a.a > 0 || b.a > 0)) {
      const double depth = length * meanExtinction(a.a, b.a);
      const double origin = glm::dvec3(a) == glm::dvec3(b) ? 0.5 : meanOrigin(a.a, b.a, length, depth);
      color += transmittance * -std::expm1(-depth) * glm::dvec3(between(a, b, origin));
      transmittance *= std::exp(-depth);
    }
    if (to == back) break;
    from = to;
    index += back > front ? 1 : -1;
  }
  return glm::dvec4(color, 1 - transmittance);
}

} // namespace volmark::reference
