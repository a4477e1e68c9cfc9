#include "volume/generators/portable_math.h"
#include "volume/generators/tubes.h"

#include <algorithm>
#include <cmath>

namespace volmark {

namespace {

constexpr int kPieces = 4;            ///< straight pieces of a branch
constexpr double kWinding = 0.06;     ///< how far the line winds to a side, in branch lengths
constexpr double kSmallestFlow = 0.3; ///< share of the flow that the thinner child gets at least
constexpr double kTwist = 0.5;        ///< how far the plane of a bifurcation is off at most, in quarter turns

/// A branch that is yet to grow.
struct Bud {
  int parent;
  int generation;
  glm::dvec3 start;
  glm::dvec3 direction;
  glm::dvec3 normal; ///< of the plane of the bifurcation at its end, orthogonal to the direction
  double radius;
  double length;
};

/// Numbers of one branch.
class Dice {
public:
  Dice(std::uint32_t seed, std::size_t branch) : m_seed(seed), m_branch(static_cast<std::uint32_t>(branch)) {}
  double between(double low, double high) { return low + (high - low) * randomUnit(m_seed, m_branch, m_index++); }

private:
  std::uint32_t m_seed;
  std::uint32_t m_branch;
  std::uint32_t m_index = 0;
};

glm::dvec3 unit(const glm::dvec3& v) {
  return v / std::sqrt(glm::dot(v, v));
}

/// Some unit vector orthogonal to a unit vector.
glm::dvec3 orthogonalTo(const glm::dvec3& v) {
  return unit(std::abs(v.x) < 0.6 ? glm::cross(v, {1, 0, 0}) : glm::cross(v, {0, 1, 0}));
}

/// Mirrors a bud that would leave the ellipsoid at the wall.
void turnBack(Bud& bud, const TreeSettings& settings) {
  const glm::dvec3 tip = (bud.start + bud.length * bud.direction - settings.centre) / settings.semiAxes;
  if (glm::dot(tip, tip) <= 1) return;
  const glm::dvec3 wall = unit(tip / settings.semiAxes);
  const double outwards = glm::dot(bud.direction, wall);
  if (outwards <= 0) return;
  bud.direction -= 2 * outwards * wall;
  bud.normal -= 2 * glm::dot(bud.normal, wall) * wall;
}

std::vector<glm::dvec3> windingLine(const Bud& bud, Dice& dice) {
  const glm::dvec3 side = glm::cross(bud.normal, bud.direction);
  std::vector<glm::dvec3> points = {bud.start};
  for (int i = 1; i < kPieces; ++i) {
    // In statements of their own: compilers choose the order within an expression.
    const double up = dice.between(-kWinding, kWinding);
    const double sideways = dice.between(-kWinding, kWinding);
    points.push_back(bud.start +
                     bud.length * (double(i) / kPieces * bud.direction + up * bud.normal + sideways * side));
  }
  points.push_back(bud.start + bud.length * bud.direction);
  return points;
}

/// Child of a branch, turned by the angle of `cosine` to one side (1) or the other (-1) in the bifurcation's plane.
Bud child(const Bud& bud, int index, const glm::dvec3& start, double radius, double cosine, int side, Dice& dice) {
  const glm::dvec3 inPlane = glm::cross(bud.normal, bud.direction);
  const double sine = side * std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const glm::dvec3 direction = unit(cosine * bud.direction + sine * inPlane);
  const double twist = dice.between(-kTwist, kTwist);
  const glm::dvec3 normal =
      cosineOfQuarterTurns(twist) * glm::cross(bud.normal, direction) + sineOfQuarterTurns(twist) * bud.normal;
  const double length = bud.length * radius / bud.radius * dice.between(0.85, 1.15);
  return {index, bud.generation + 1, start, direction, normal, radius, length};
}

} // namespace

std::vector<Branch> growTree(const TreeSettings& settings) {
  std::vector<Bud> buds = {
      {-1, 0, settings.root, settings.direction, orthogonalTo(settings.direction), settings.radius, settings.length}};
  std::vector<Branch> branches;
  for (std::size_t i = 0; i < buds.size(); ++i) {
    Dice dice(settings.seed, i);
    Bud bud = buds[i];
    turnBack(bud, settings);
    branches.push_back({bud.parent, bud.radius, windingLine(bud, dice)});
    if (bud.generation == settings.generations) continue;

    // Flow is in proportion to the cubed radius; Murray's angles to the parent's direction follow from the radii.
    const double flow = dice.between(kSmallestFlow, 1 - kSmallestFlow);
    const double r0 = bud.radius;
    const double r1 = r0 * power(flow, 1.0 / 3);
    const double r2 = r0 * power(1 - flow, 1.0 / 3);
    const double squared = r0 * r0;
    const double difference = (r1 * r1 * r1 * r1 - r2 * r2 * r2 * r2) / squared;
    const double cosine1 = (squared + difference) / (2 * r1 * r1);
    const double cosine2 = (squared - difference) / (2 * r2 * r2);
    const glm::dvec3 tip = branches.back().points.back();
    const int index = static_cast<int>(i);
    buds.push_back(child(bud, index, tip, r1, cosine1, 1, dice));
    buds.push_back(child(bud, index, tip, r2, cosine2, -1, dice));
  }
  return branches;
}

std::vector<Tube> tubesOf(const std::vector<Branch>& branches) {
  std::vector<Tube> tubes;
  for (const Branch& branch : branches)
    for (std::size_t i = 1; i < branch.points.size(); ++i)
      tubes.push_back({branch.points[i - 1], branch.points[i], branch.radius});
  return tubes;
}

} // namespace volmark
