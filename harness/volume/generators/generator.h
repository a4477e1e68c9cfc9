// Analytic scalar fields, with exact gradients, sampled to volumes of any size.
#pragma once

#include "volmark/parameters.h"
#include "volmark/volume.h"

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace volmark {

/// A scalar field over [-1,1]^3 with values in [0,1], or labels (whole numbers). Shared between threads.
class Field {
public:
  virtual ~Field() = default;
  virtual double value(const glm::dvec3& p) const = 0;
  /// Exact; of fields with creases (where the value is a maximum of two, or clamped) that of one side.
  virtual glm::dvec3 gradient(const glm::dvec3& p) const = 0;
  /// values[j * xs.size() + i] = value({xs[i], ys[j], z}), bit by bit; xs and ys ascend. Overridden by fields that
  /// are faster a slice at a time.
  virtual void sampleSlice(std::span<const double> xs, std::span<const double> ys, double z,
                           std::span<double> values) const;
};

struct GeneratorSettings {
  std::string name; ///< one of generatorNames()
  glm::ivec3 dims{64};
  glm::dvec3 spacingMm{1.0};
  ScalarType type = ScalarType::uint8;
  std::map<std::string, double> parameters; ///< defaults where absent
};

std::vector<std::string> generatorNames();
/// Throws InputError for an unknown name.
const std::vector<ParameterDescriptor>& generatorParameters(const std::string& name);

/// Throws InputError for an unknown name or parameter, or a value that isn't allowed.
void checkGenerator(const GeneratorSettings& settings);
/// Steps of a field that changes with time, its parameter "time_steps"; 1 of others. Throws as checkGenerator does.
int timeStepsOf(const GeneratorSettings& settings);
/// `timeStep`: from 0 to timeStepsOf(settings)-1. Throws as checkGenerator does.
std::unique_ptr<Field> makeField(const GeneratorSettings& settings, int timeStep = 0);

/// The factor from field value to voxel value: the type's largest value (int8 127, uint8 255, int16 32767, uint16
/// 65535), and 1 for float32 and for labels.
double voxelUnit(const GeneratorSettings& settings);

/// Samples the field at voxel centres: voxel i of n lies at -1 + 2i/(n-1), the only voxel of an axis at 0.
/// Integer types: the field's value times the unit, rounded to nearest, halves up; float32 as computed. Equal bytes for
/// equal settings on every machine and for any number of threads (0: one per processor): nothing but correctly
/// rounded operations is used. Throws InputError as checkGenerator does, and for dims below 1 or too large for memory.
std::shared_ptr<const Volume> generateVolume(const GeneratorSettings& settings, int threads = 0);

} // namespace volmark
