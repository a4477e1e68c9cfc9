// Piecewise linear map from normalised scalar to colour and opacity.
#pragma once

#include <glm/glm.hpp>

#include <string>
#include <vector>

namespace volmark {

/// Opacity is what a slab of one voxel length (the smallest spacing) absorbs. It is capped here, for
/// techniques and reference alike, so that extinction -ln(1-opacity) stays finite.
inline constexpr double kMaximumOpacity = 0.9999;

struct ControlPoint {
  double value = 0;      ///< normalised scalar, [0,1]
  glm::dvec3 color{0.0}; ///< linear Rec.709, straight (not premultiplied), [0,1]
  double opacity = 0;    ///< per voxel length, [0,1]; used as min(opacity, kMaximumOpacity)
};

class TransferFunction {
public:
  TransferFunction() = default;
  /// `points`: at least one, values ascending (two equal values make a jump: the later point holds from
  /// there on). Throws InputError.
  TransferFunction(std::string name, std::vector<ControlPoint> points);

  /// Colours and opacities (1-share) of `from` and share of `to`, at every scalar. `share` in [0,1].
  static TransferFunction blend(const TransferFunction& from, const TransferFunction& to, double share);

  const std::string& name() const { return m_name; }
  const std::vector<ControlPoint>& points() const { return m_points; }

  /// Straight colour and capped opacity at a normalised scalar; constant beyond the first and last point.
  glm::dvec4 evaluate(double value) const;

  /// `size` >= 2 samples at i/(size-1).
  std::vector<glm::vec4> table(int size) const;

  /// Pre-integrated table (Engel, Kraus, Ertl 2001, section 3): size*size premultiplied colours and
  /// opacities of a slab `stepVoxels` long, entered at value column/(size-1) and left at row/(size-1), with
  /// the scalar linear in between; self-attenuation inside the slab included.
  std::vector<glm::vec4> preintegratedTable(int size, double stepVoxels) const;

private:
  std::string m_name;
  std::vector<ControlPoint> m_points;
};

} // namespace volmark
