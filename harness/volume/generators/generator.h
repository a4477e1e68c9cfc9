// Analytic scalar fields, with exact gradients, sampled to volumes of any size.
#pragma once

#include "volmark/volume.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace volmark {

/// A scalar field over [-1,1]^3.
class Field {
public:
  virtual ~Field() = default;
  virtual double value(const glm::dvec3& p) const = 0;
  virtual glm::dvec3 gradient(const glm::dvec3& p) const = 0;
};

struct GeneratorSettings {
  std::string name;                              ///< "marschner_lobb" or "nested_ellipsoids"
  glm::ivec3 dims{64};
  glm::dvec3 spacingMm{1.0};
  ScalarType type = ScalarType::uint8;
  std::map<std::string, double> parameters;      ///< defaults where absent
};

std::vector<std::string> generatorNames();
/// Names, defaults and documentation of a generator's parameters, one line each.
std::vector<std::string> generatorDocumentation(const std::string& name);

/// Throws InputError for an unknown name or parameter.
std::unique_ptr<Field> makeField(const GeneratorSettings& settings);

/// Samples the field at voxel centres: voxel i of n lies at -1 + 2i/(n-1). Integer types: the field's value
/// times the type's documented unit, rounded to nearest; float32 as computed. Equal bytes for equal settings.
std::shared_ptr<const Volume> generateVolume(const GeneratorSettings& settings);

/// The factor from field value to voxel value in generateVolume.
double voxelUnit(const GeneratorSettings& settings);

} // namespace volmark
