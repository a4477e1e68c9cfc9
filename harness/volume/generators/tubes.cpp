#include "volume/generators/tubes.h"

#include "volume/generators/portable_math.h"

#include <algorithm>
#include <cmath>

namespace volmark {

namespace {

/// Indices of ascending positions within [minimum, maximum].
std::pair<std::size_t, std::size_t> indicesWithin(std::span<const double> positions, double minimum, double maximum) {
  const auto first = std::lower_bound(positions.begin(), positions.end(), minimum);
  const auto last = std::upper_bound(first, positions.end(), maximum);
  return {static_cast<std::size_t>(first - positions.begin()), static_cast<std::size_t>(last - positions.begin())};
}

} // namespace

Tubes::Tubes(std::vector<Tube> tubes, double edgeWidth) {
  for (const Tube& tube : tubes) {
    const glm::dvec3 along = tube.end - tube.start;
    const double squaredLength = glm::dot(along, along);
    // The share ends where the squared distance is radius^2 + radius edgeWidth; a little more for rounding.
    const double reach = std::sqrt(tube.radius * (tube.radius + edgeWidth)) + 1e-9;
    m_bodies.push_back({.start = tube.start,
                        .along = along,
                        .perSquaredLength = squaredLength > 0 ? 1 / squaredLength : 0,
                        .squaredRadius = tube.radius * tube.radius,
                        .perEdge = 1 / (2 * tube.radius * edgeWidth),
                        .boxMinimum = glm::min(tube.start, tube.end) - reach,
                        .boxMaximum = glm::max(tube.start, tube.end) + reach});
  }
}

bool Tubes::isInBox(const Body& body, const glm::dvec3& p) {
  return p.x >= body.boxMinimum.x && p.x <= body.boxMaximum.x && p.y >= body.boxMinimum.y && p.y <= body.boxMaximum.y &&
         p.z >= body.boxMinimum.z && p.z <= body.boxMaximum.z;
}

/// From the nearest point of the tube's line to p.
glm::dvec3 Tubes::fromLine(const Body& body, const glm::dvec3& p) {
  const glm::dvec3 offset = p - body.start;
  return offset - std::clamp(glm::dot(offset, body.along) * body.perSquaredLength, 0.0, 1.0) * body.along;
}

/// Where p is within the soft edge: 0 at its outside, 1 at its inside.
double Tubes::edgePosition(const Body& body, const glm::dvec3& p) {
  const glm::dvec3 offset = fromLine(body, p);
  return 0.5 + (body.squaredRadius - glm::dot(offset, offset)) * body.perEdge;
}

double Tubes::value(const glm::dvec3& p) const {
  double position = 0;
  for (const Body& body : m_bodies)
    if (isInBox(body, p)) position = std::max(position, edgePosition(body, p));
  return smoothStep(position);
}

glm::dvec3 Tubes::gradient(const glm::dvec3& p) const {
  double position = 0;
  const Body* nearest = nullptr;
  for (const Body& body : m_bodies) {
    if (!isInBox(body, p)) continue;
    const double t = edgePosition(body, p);
    if (t > position) nearest = &body;
    position = std::max(position, t);
  }
  if (!nearest) return glm::dvec3(0.0);
  return -2 * smoothStepSlope(position) * nearest->perEdge * fromLine(*nearest, p);
}

void Tubes::sampleSlice(std::span<const double> xs, std::span<const double> ys, double z,
                        std::span<double> values) const {
  std::fill(values.begin(), values.end(), 0.0);
  for (const Body& body : m_bodies) {
    if (z < body.boxMinimum.z || z > body.boxMaximum.z) continue;
    const auto [firstX, endX] = indicesWithin(xs, body.boxMinimum.x, body.boxMaximum.x);
    const auto [firstY, endY] = indicesWithin(ys, body.boxMinimum.y, body.boxMaximum.y);
    for (std::size_t j = firstY; j < endY; ++j)
      for (std::size_t i = firstX; i < endX; ++i) {
        double& position = values[j * xs.size() + i];
        position = std::max(position, edgePosition(body, {xs[i], ys[j], z}));
      }
  }
  for (double& value : values)
    value = smoothStep(value);
}

} // namespace volmark
