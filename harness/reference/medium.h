// A transfer function as a participating medium: colour and extinction against the scalar, slabs in closed form.
#pragma once

#include "volmark/transfer_function.h"

#include <vector>

namespace volmark::reference {

/// Cut into pieces over which colour and opacity are both linear in the scalar; the caps of opacity and of the scalar's
/// range have pieces of their own. Scalars need not be clamped.
class Medium {
public:
  explicit Medium(const TransferFunction& function);

  /// Straight colour, and opacity per voxel length.
  glm::dvec4 evaluate(double value) const;

  /// Whether all scalars of [low, high] have no opacity.
  bool isTransparent(double low, double high) const;

  /// Scalars where the function bends or jumps, ascending; it is linear in between.
  const std::vector<double>& bends() const { return m_bends; }

  /// Premultiplied colour and opacity of a slab in which the scalar runs linearly from `front` to `back`, its own
  /// attenuation included. Opacity is exact to rounding, colour to about 1e-6 of it.
  glm::dvec4 slab(double front, double back, double lengthVoxels) const;

private:
  struct Piece {
    double low, high;         // scalars; the outer ones are infinite, and constant
    glm::dvec4 atLow, atHigh; // straight colour and opacity
    glm::dvec4 at(double value) const;
  };
  std::size_t indexOf(double value) const;
  void addPiece(Piece piece);

  std::vector<Piece> m_pieces; // ascending, without gaps; each holds from its low end on
  std::vector<double> m_bends;
};

} // namespace volmark::reference
