// Analytic scalar fields, with exact gradients, sampled to volumes of any size.
#pragma once

#include "volmark/volume.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace volmark {

/// A scalar field over [-1,1]^3 with values in [0,1].
class Field {
public:
  virtual ~Field() = default;
  virtual double value(const glm::dvec3& p) const = 0;
  virtual glm::dvec3 gradient(const glm::dvec3& p) const = 0;
};

struct GeneratorSettings {
  std::string name; ///< "marschner_lobb" or "nested_ellipsoids"
  glm::ivec3 dims{64};
  glm::dvec3 spacingMm{1.0};
  ScalarType type = ScalarType::uint8;
  std::map<std::string, double> parameters; ///< defaults where absent
};

std::vector<std::string> generatorNames();
/// Names, defaults and documentation of a generator's parameters, one line each. Throws InputError.
std::vector<std::string> generatorDocumentation(const std::string& name);

/// Throws InputError for an unknown name or parameter, or a value that isn't allowed.
std::unique_ptr<Field> makeField(const GeneratorSettings& settings);

/// Samples the field at voxel centres: voxel i of n lies at -1 + 2i/(n-1), the only voxel of an axis at 0.
/// Integer types: the field's value times the type's unit, rounded to nearest, halves up; float32 as computed.
/// Equal bytes for equal settings on every machine: nothing but correctly rounded operations is used. Throws
/// InputError as makeField does, and for dims below 1 or too large for memory.
std::shared_ptr<const Volume> generateVolume(const GeneratorSettings& settings);

/// The factor from field value to voxel value in generateVolume: the type's largest value (int8 127, uint8
/// 255, int16 32767, uint16 65535), and 1 for float32.
double voxelUnit(const GeneratorSettings& settings);

} // namespace volmark
