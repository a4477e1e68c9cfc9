// Bodies painted one over the other, as values or as labels.
#pragma once

#include "volume/generators/generator.h"

#include <memory>
#include <vector>

namespace volmark {

/// A body and what it is made of.
struct Layer {
  std::shared_ptr<const Field> share; ///< how much the body covers a point, [0,1]; 0.5 on its surface
  double plateau = 0;                 ///< the value where it covers all, [0,1]
  int label = 0;
};

/// How much a soft-edged ellipsoid covers a point: 0.5 on the ellipsoid.
class Ellipsoid : public Field {
public:
  /// `edgeWidth`: length from 0 to 1 along the shortest axis, more along longer ones.
  Ellipsoid(const glm::dvec3& centre, const glm::dvec3& semiAxes, double edgeWidth);

  double value(const glm::dvec3& p) const override;
  glm::dvec3 gradient(const glm::dvec3& p) const override;

private:
  glm::dvec3 m_centre;
  glm::dvec3 m_semiAxes;
  double m_perRadius; ///< edge widths per length of the shortest axis
};

/// How much a soft-edged barrel covers a point: 0.5 where ((x/a)^2 + (y/b)^2)^2 + (z/c)^4 is 1. Around the origin.
class Barrel : public Field {
public:
  /// `semiAxes`: a, b, c. `edgeWidth` as of Ellipsoid.
  Barrel(const glm::dvec3& semiAxes, double edgeWidth);

  double value(const glm::dvec3& p) const override;
  glm::dvec3 gradient(const glm::dvec3& p) const override;

private:
  /// 1 on the surface, in proportion to the distance from the centre.
  double radius(const glm::dvec3& p) const;

  glm::dvec3 m_semiAxes;
  double m_perRadius;
};

/// Values of layers painted one over the other, from 0.
class Painting : public Field {
public:
  explicit Painting(std::vector<Layer> layers) : m_layers(std::move(layers)) {}

  double value(const glm::dvec3& p) const override;
  glm::dvec3 gradient(const glm::dvec3& p) const override;
  void sampleSlice(std::span<const double> xs, std::span<const double> ys, double z,
                   std::span<double> values) const override;

private:
  std::vector<Layer> m_layers;
};

/// The label of the last layer that covers at least half of a point, 0 if none does.
class LabelPainting : public Field {
public:
  explicit LabelPainting(std::vector<Layer> layers) : m_layers(std::move(layers)) {}

  double value(const glm::dvec3& p) const override;
  glm::dvec3 gradient(const glm::dvec3&) const override { return glm::dvec3(0.0); }
  void sampleSlice(std::span<const double> xs, std::span<const double> ys, double z,
                   std::span<double> values) const override;

private:
  std::vector<Layer> m_layers;
};

/// A head phantom of soft-edged ellipsoids. Plateaus: kAir outside and in the sinus, kSkin, kBone for the skull and the
/// sinus' wall, kBrain, kFluid in the ventricles. x points to the left ear, y to the back, z to the crown; the faces
/// of the cube are air.
class NestedEllipsoids : public Painting {
public:
  static constexpr double kAir = 0.0;
  static constexpr double kSkin = 0.3;
  static constexpr double kBone = 0.9;
  static constexpr double kBrain = 0.45;
  static constexpr double kFluid = 0.38;

  /// `edgeWidth`: see Ellipsoid. `boneThickness`: of the skull along x.
  NestedEllipsoids(double edgeWidth, double boneThickness);
};

} // namespace volmark
