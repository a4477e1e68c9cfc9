// Vessels, bones and other long bodies: tubes with round ends, and trees grown of them.
#pragma once

#include "volume/generators/generator.h"

#include <vector>

namespace volmark {

/// A line segment with a radius; > 0.
struct Tube {
  glm::dvec3 start;
  glm::dvec3 end;
  double radius;
};

/// How much the union of soft-edged tubes covers a point: 0.5 at `radius` from the nearest line, smooth across it. The
/// edge falls with the squared distance, so that the value is smooth on the line too; with its slope at the radius
/// it would take `edgeWidth` from 0 to 1. Tubes thinner than the edge don't reach 1.
class Tubes : public Field {
public:
  Tubes(std::vector<Tube> tubes, double edgeWidth);

  double value(const glm::dvec3& p) const override;
  /// Of the tube that covers the point most.
  glm::dvec3 gradient(const glm::dvec3& p) const override;
  void sampleSlice(std::span<const double> xs, std::span<const double> ys, double z,
                   std::span<double> values) const override;

private:
  struct Body {
    glm::dvec3 start;
    glm::dvec3 along;
    double perSquaredLength; ///< 1 / |along|^2, 0 if start is end
    double squaredRadius;
    double perEdge; ///< 1 / (2 radius edgeWidth)
    glm::dvec3 boxMinimum;
    glm::dvec3 boxMaximum; ///< outside of the box the tube covers nothing
  };
  static bool isInBox(const Body& body, const glm::dvec3& p);
  static glm::dvec3 fromLine(const Body& body, const glm::dvec3& p);
  static double edgePosition(const Body& body, const glm::dvec3& p);

  std::vector<Body> m_bodies;
};

/// How a vessel tree grows.
struct TreeSettings {
  glm::dvec3 root;
  glm::dvec3 direction; ///< of the root branch, unit length
  double radius;        ///< of the root branch
  double length;        ///< of the root branch
  int generations;      ///< bifurcations from root to tip; there are 2^(generations+1) - 1 branches
  glm::dvec3 centre;    ///< of the ellipsoid whose wall turns branches back
  glm::dvec3 semiAxes;
  std::uint32_t seed;
};

/// One vessel from bifurcation to bifurcation.
struct Branch {
  int parent; ///< index, -1 for the root; parents come first
  double radius;
  std::vector<glm::dvec3> points; ///< of its line, at least two; the first is the parent's last
};

/// A random tree of bifurcations that keep Murray's law, r0^3 = r1^3 + r2^3, at his angles (C. D. Murray, "The
/// Physiological Principle of Minimum Work Applied to the Angle of Branching of Arteries", 1926). Lengths are in
/// proportion to radii, and the plane of a bifurcation is about orthogonal to that of the one before.
std::vector<Branch> growTree(const TreeSettings& settings);

/// A tube along each piece of the branches' lines.
std::vector<Tube> tubesOf(const std::vector<Branch>& branches);

} // namespace volmark
