#include "volume/generators/generator.h"

#include "volmark/error.h"
#include "volmark/parameters.h"
#include "volume/generators/fields.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

namespace volmark {

namespace {

struct Generator {
  std::string name;
  std::vector<ParameterDescriptor> parameters;
  std::function<std::unique_ptr<Field>(const ParameterValues&)> make;
};

const std::vector<Generator>& generators() {
  static const std::vector<Generator> all = {
      {"marschner_lobb",
       {ParameterDescriptor::number("f_m", 6, 0, 1000, "", "Frequency of the chirp, cycles per unit length."),
        ParameterDescriptor::number("alpha", 0.25, 0, 10, "", "Amplitude of the chirp.")},
       [](const ParameterValues& values) {
         return std::make_unique<MarschnerLobb>(values.number("f_m"), values.number("alpha"));
       }},
      {"nested_ellipsoids",
       {ParameterDescriptor::number("edge_width", 0.03, 0.001, 0.05, "",
                                    "Width of the soft edges; the cube is 2 wide."),
        ParameterDescriptor::number("bone_thickness", 0.08, 0.02, 0.2, "",
                                    "Thickness of the skull; the cube is 2 wide.")},
       [](const ParameterValues& values) {
         return std::make_unique<NestedEllipsoids>(values.number("edge_width"), values.number("bone_thickness"));
       }},
  };
  return all;
}

const Generator& findGenerator(const std::string& name) {
  for (const Generator& generator : generators())
    if (generator.name == name) return generator;
  const std::vector<std::string> names = generatorNames();
  const auto nearest = nearestName(name, names);
  throw InputError(fmt::format("generator: found \"{}\", allowed: {}{}", name, fmt::join(names, ", "),
                               nearest ? fmt::format("; did you mean \"{}\"?", *nearest) : ""));
}

std::vector<double> axisPositions(int count) {
  std::vector<double> positions(static_cast<std::size_t>(count), 0.0);
  if (count == 1) return positions;
  for (int i = 0; i < count; ++i)
    positions[static_cast<std::size_t>(i)] = -1 + 2.0 * i / (count - 1);
  return positions;
}

template <class T> T toVoxel(double value, double unit) {
  if constexpr (std::is_floating_point_v<T>) return static_cast<T>(value);
  const double low = std::numeric_limits<T>::lowest();
  const double high = std::numeric_limits<T>::max();
  return static_cast<T>(std::clamp(std::floor(value * unit + 0.5), low, high));
}

template <class T> void sample(const Field& field, const GeneratorSettings& settings, std::vector<std::byte>& bytes) {
  const double unit = voxelUnit(settings);
  const std::vector<double> xs = axisPositions(settings.dims.x);
  const std::vector<double> ys = axisPositions(settings.dims.y);
  const std::vector<double> zs = axisPositions(settings.dims.z);
  std::byte* next = bytes.data();
  for (const double z : zs)
    for (const double y : ys)
      for (const double x : xs) {
        const T voxel = toVoxel<T>(field.value({x, y, z}), unit);
        std::memcpy(next, &voxel, sizeof(T));
        next += sizeof(T);
      }
}

} // namespace

std::vector<std::string> generatorNames() {
  std::vector<std::string> names;
  for (const Generator& generator : generators())
    names.push_back(generator.name);
  return names;
}

std::vector<std::string> generatorDocumentation(const std::string& name) {
  std::vector<std::string> lines;
  for (const ParameterDescriptor& parameter : findGenerator(name).parameters)
    lines.push_back(fmt::format("{} = {} ({} to {}): {}", parameter.name, std::get<double>(parameter.defaultValue),
                                *parameter.minimum, *parameter.maximum, parameter.documentation));
  return lines;
}

std::unique_ptr<Field> makeField(const GeneratorSettings& settings) {
  const Generator& generator = findGenerator(settings.name);
  ParameterValues values(generator.parameters);
  for (const auto& [name, value] : settings.parameters) {
    try {
      values.set(name, value);
    } catch (const InputError& error) {
      throw InputError(fmt::format("generator {}: {}", generator.name, error.what()));
    }
  }
  return generator.make(values);
}

double voxelUnit(const GeneratorSettings& settings) {
  switch (settings.type) {
  case ScalarType::int8: return std::numeric_limits<std::int8_t>::max();
  case ScalarType::uint8: return std::numeric_limits<std::uint8_t>::max();
  case ScalarType::int16: return std::numeric_limits<std::int16_t>::max();
  case ScalarType::uint16: return std::numeric_limits<std::uint16_t>::max();
  case ScalarType::float32: return 1;
  }
  return 1;
}

std::shared_ptr<const Volume> generateVolume(const GeneratorSettings& settings) {
  const std::unique_ptr<Field> field = makeField(settings);
  const std::string place = fmt::format("generator {}", settings.name);
  const Grid grid{settings.dims, settings.spacingMm};
  std::vector<std::byte> bytes = allocateVoxels(
      place, checkedVoxelBytes(place, grid, settings.type, 1, std::numeric_limits<std::uint64_t>::max()));
  switch (settings.type) {
  case ScalarType::int8: sample<std::int8_t>(*field, settings, bytes); break;
  case ScalarType::uint8: sample<std::uint8_t>(*field, settings, bytes); break;
  case ScalarType::int16: sample<std::int16_t>(*field, settings, bytes); break;
  case ScalarType::uint16: sample<std::uint16_t>(*field, settings, bytes); break;
  case ScalarType::float32: sample<float>(*field, settings, bytes); break;
  }
  return std::make_shared<const Volume>(settings.name, grid, settings.type, std::move(bytes));
}

} // namespace volmark
