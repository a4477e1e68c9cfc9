// Fields in closed form.
#pragma once

#include "volume/generators/generator.h"

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

/// 0.5 on a surface, 1 where it is `band` or more inside, 0 where it is `band` or more outside, linear in the signed
/// distance between.
class DistanceField : public Field {
public:
  explicit DistanceField(double band) : m_band(band) {}

  /// To the surface, negative inside.
  virtual double distance(const glm::dvec3& p) const = 0;
  /// Gradient of the distance, a unit vector; 0 where there is none.
  virtual glm::dvec3 direction(const glm::dvec3& p) const = 0;

  double value(const glm::dvec3& p) const override;
  glm::dvec3 gradient(const glm::dvec3& p) const override;

private:
  double m_band;
};

/// Around the origin.
class Sphere : public DistanceField {
public:
  Sphere(double radius, double band) : DistanceField(band), m_radius(radius) {}

  double distance(const glm::dvec3& p) const override;
  glm::dvec3 direction(const glm::dvec3& p) const override;

private:
  double m_radius;
};

/// Around the z axis; the tube's centre line lies in z = 0.
class Torus : public DistanceField {
public:
  Torus(double majorRadius, double minorRadius, double band)
      : DistanceField(band), m_majorRadius(majorRadius), m_minorRadius(minorRadius) {}

  double distance(const glm::dvec3& p) const override;
  glm::dvec3 direction(const glm::dvec3& p) const override;

private:
  double m_majorRadius;
  double m_minorRadius;
};

/// 0.5 + g/3 with the level function g = sin X cos Y + sin Y cos Z + sin Z cos X of Schoen's gyroid, |g| <= 3/2, where
/// X, Y, Z are `periods` turns over the cube's width. Not a distance: near the surface that is about g / |grad g|,
/// the wall bends too much for more.
class Gyroid : public Field {
public:
  explicit Gyroid(double periods) : m_quarterTurns(2 * periods) {}

  double value(const glm::dvec3& p) const override;
  glm::dvec3 gradient(const glm::dvec3& p) const override;

private:
  double m_quarterTurns; ///< per unit length
};

} // namespace volmark
