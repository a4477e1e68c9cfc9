// The fields that generators sample.
#pragma once

#include "volume/generators/generator.h"

#include <glm/glm.hpp>

#include <vector>

namespace volmark {

/// The test signal of Marschner and Lobb, "An Evaluation of Reconstruction Filters for Volume Rendering"
/// (1994), section 5: a radial chirp in x and y, half a sine along z.
class MarschnerLobb : public Field {
public:
  MarschnerLobb(double frequency, double amplitude) : m_frequency(frequency), m_amplitude(amplitude) {}

  double value(const glm::dvec3& p) const override;
  glm::dvec3 gradient(const glm::dvec3& p) const override;

private:
  double m_frequency; ///< f_M: cycles per unit length at most
  double m_amplitude; ///< alpha: share of the chirp
};

/// A head phantom of soft-edged ellipsoids, painted one over the other. Plateaus: kAir outside and in the
/// sinus, kSkin, kBone for the skull and the sinus' wall, kBrain, kFluid in the ventricles. x points to the
/// left ear, y to the back, z to the crown; the faces of the cube are air.
class NestedEllipsoids : public Field {
public:
  static constexpr double kAir = 0.0;
  static constexpr double kSkin = 0.3;
  static constexpr double kBone = 0.9;
  static constexpr double kBrain = 0.45;
  static constexpr double kFluid = 0.38;

  /// `edgeWidth`: length over which a plateau turns into the next along an ellipsoid's shortest axis, more
  /// along longer ones; the half-way value lies on the ellipsoid. `boneThickness`: of the skull along x.
  NestedEllipsoids(double edgeWidth, double boneThickness);

  double value(const glm::dvec3& p) const override;
  glm::dvec3 gradient(const glm::dvec3& p) const override;

private:
  struct Layer {
    glm::dvec3 centre;
    glm::dvec3 semiAxes;
    double plateau;
  };
  struct Share {
    double value = 0; ///< how much the layer covers a point, [0,1]
    glm::dvec3 gradient{0.0};
  };
  Share shareOf(const Layer& layer, const glm::dvec3& p) const;

  double m_edgeWidth;
  std::vector<Layer> m_layers; ///< in painting order
};

/// Sine and cosine of `t` quarter turns, |t| < 1e9, to about 1e-16: only +, - and * of doubles, so that results are
/// the same on every machine, unlike those of the C library.
double sineOfQuarterTurns(double t);
double cosineOfQuarterTurns(double t);

} // namespace volmark
