#include "volmark/transfer_function.h"

#include "volmark/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace volmark {

TransferFunction::TransferFunction(std::string name, std::vector<ControlPoint> points)
    : m_name(std::move(name)), m_points(std::move(points)) {
  if (m_points.empty())
    throw InputError(fmt::format("transfer function \"{}\": no control points, allowed: at least one", m_name));
  for (std::size_t i = 1; i < m_points.size(); ++i)
    if (m_points[i].value < m_points[i - 1].value)
      throw InputError(fmt::format("transfer function \"{}\": point {} has value {} after {}, allowed: ascending",
                                   m_name, i, m_points[i].value, m_points[i - 1].value));
}

glm::dvec4 TransferFunction::evaluate(double value) const {
  assert(!m_points.empty());
  const auto at = [](const ControlPoint& point) {
    return glm::dvec4(point.color, std::min(point.opacity, kMaximumOpacity));
  };
  const auto next = std::upper_bound(m_points.begin(), m_points.end(), value,
                                     [](double v, const ControlPoint& point) { return v < point.value; });
  if (next == m_points.begin()) return at(m_points.front());
  if (next == m_points.end()) return at(m_points.back());
  const ControlPoint& low = *(next - 1);
  const double t = (value - low.value) / (next->value - low.value);
  // Opacity is capped after interpolation, so that a ramp to 1 keeps its slope.
  glm::dvec4 result = glm::mix(glm::dvec4(low.color, low.opacity), glm::dvec4(next->color, next->opacity), t);
  result.a = std::min(result.a, kMaximumOpacity);
  return result;
}

namespace {

/// What a function is on either side of a jump; equal elsewhere. Opacity is not capped.
struct Sides {
  glm::dvec4 below;
  glm::dvec4 above;
};

Sides sidesAt(const std::vector<ControlPoint>& points, double value) {
  const auto at = [](const ControlPoint& point) { return glm::dvec4(point.color, point.opacity); };
  const auto less = [](const ControlPoint& point, double v) { return point.value < v; };
  const auto more = [](double v, const ControlPoint& point) { return v < point.value; };
  const auto first = std::lower_bound(points.begin(), points.end(), value, less); // at or above
  const auto next = std::upper_bound(points.begin(), points.end(), value, more);  // above
  if (first != next) return {at(*first), at(*(next - 1))};
  if (first == points.begin()) return {at(points.front()), at(points.front())};
  if (first == points.end()) return {at(points.back()), at(points.back())};
  const ControlPoint& low = *(first - 1);
  const double t = (value - low.value) / (first->value - low.value);
  const glm::dvec4 between = glm::mix(at(low), at(*first), t);
  return {between, between};
}

} // namespace

TransferFunction TransferFunction::blend(const TransferFunction& from, const TransferFunction& to, double share) {
  assert(share >= 0 && share <= 1);
  std::vector<double> values;
  for (const TransferFunction* function : {&from, &to})
    for (const ControlPoint& point : function->m_points)
      values.push_back(point.value);
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());

  std::vector<ControlPoint> points;
  const auto add = [&](double value, const glm::dvec4& mixed) {
    points.push_back({value, glm::dvec3(mixed), mixed.a});
  };
  for (const double value : values) {
    const Sides a = sidesAt(from.m_points, value);
    const Sides b = sidesAt(to.m_points, value);
    const glm::dvec4 below = glm::mix(a.below, b.below, share);
    const glm::dvec4 above = glm::mix(a.above, b.above, share);
    add(value, below);
    if (above != below) add(value, above);
  }
  return {from.name() + " to " + to.name(), std::move(points)};
}

std::vector<glm::vec4> TransferFunction::table(int size) const {
  assert(size >= 2);
  std::vector<glm::vec4> result(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i)
    result[static_cast<std::size_t>(i)] = glm::vec4(evaluate(double(i) / (size - 1)));
  return result;
}

namespace {

/// Emission and absorption of one slab by midpoint quadrature over its length.
glm::dvec4 integrateSlab(const TransferFunction& function, double front, double back, double stepVoxels, int parts) {
  glm::dvec4 result(0);
  for (int i = 0; i < parts; ++i) {
    const glm::dvec4 sample = function.evaluate(front + (back - front) * (i + 0.5) / parts);
    const double opacity = 1 - std::pow(1 - sample.a, stepVoxels / parts);
    const double weight = (1 - result.a) * opacity;
    result += glm::dvec4(glm::dvec3(sample) * weight, weight);
  }
  return result;
}

} // namespace

std::vector<glm::vec4> TransferFunction::preintegratedTable(int size, double stepVoxels) const {
  assert(size >= 2 && stepVoxels > 0);
  std::vector<glm::vec4> result(static_cast<std::size_t>(size) * size);
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      // Four parts per table entry crossed see every kink of a function that the table can show.
      const int parts = std::max(4, 4 * std::abs(row - column));
      const double front = double(column) / (size - 1);
      const double back = double(row) / (size - 1);
      result[static_cast<std::size_t>(row) * size + column] =
          glm::vec4(integrateSlab(*this, front, back, stepVoxels, parts));
    }
  }
  return result;
}

} // namespace volmark
