// The generators by name, with their parameters.
#include "volmark/error.h"
#include "volume/generators/blast_wave.h"
#include "volume/generators/fields.h"
#include "volume/generators/noise.h"
#include "volume/generators/phantom.h"
#include "volume/generators/tubes.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <limits>

namespace volmark {

namespace {

using Parameter = ParameterDescriptor;

struct Generator {
  std::string name;
  std::vector<ParameterDescriptor> parameters;
  std::function<std::unique_ptr<Field>(const ParameterValues&, int timeStep)> make;
  bool makesLabels = false;
};

constexpr const char* kTimeSteps = "time_steps";

Parameter seedParameter() {
  return Parameter::integer("seed", 1, 0, std::numeric_limits<std::uint32_t>::max(), "", "Seed of the random numbers.");
}

Parameter edgeWidthParameter(double maximum) {
  return Parameter::number("edge_width", 0.03, 0.001, maximum, "", "Width of the soft edges; the cube is 2 wide.");
}

std::uint32_t seedOf(const ParameterValues& values) {
  return static_cast<std::uint32_t>(values.integer("seed"));
}

int wholeOf(const ParameterValues& values, std::string_view name) {
  return static_cast<int>(values.integer(name));
}

std::unique_ptr<Field> makeMarschnerLobb(const ParameterValues& values, int) {
  return std::make_unique<MarschnerLobb>(values.number("f_m"), values.number("alpha"));
}

std::unique_ptr<Field> makeNestedEllipsoids(const ParameterValues& values, int) {
  return std::make_unique<NestedEllipsoids>(values.number("edge_width"), values.number("bone_thickness"));
}

std::unique_ptr<Field> makeSphere(const ParameterValues& values, int) {
  return std::make_unique<Sphere>(values.number("radius"), values.number("band"));
}

std::unique_ptr<Field> makeTorus(const ParameterValues& values, int) {
  return std::make_unique<Torus>(values.number("major_radius"), values.number("minor_radius"), values.number("band"));
}

std::unique_ptr<Field> makeGyroid(const ParameterValues& values, int) {
  return std::make_unique<Gyroid>(values.number("periods"));
}

std::unique_ptr<Field> makeNoise(const ParameterValues& values, int) {
  return std::make_unique<Noise>(values.number("beta"), wholeOf(values, "lowest_frequency"),
                                 wholeOf(values, "highest_frequency"), seedOf(values));
}

std::unique_ptr<Field> makeVesselTree(const ParameterValues& values, int) {
  const TreeSettings settings{.root = {0, 0, -0.9},
                              .direction = {0, 0, 1},
                              .radius = values.number("root_radius"),
                              .length = 0.58,
                              .generations = wholeOf(values, "generations"),
                              .centre = {0, 0, 0},
                              .semiAxes = glm::dvec3(0.88),
                              .seed = seedOf(values)};
  return std::make_unique<Tubes>(tubesOf(growTree(settings)), values.number("edge_width"));
}

std::vector<Layer> phantomOf(const ParameterValues& values) {
  return phantomLayers({values.number("edge_width"), wholeOf(values, "vessel_generations"), seedOf(values)});
}

std::unique_ptr<Field> makePhantom(const ParameterValues& values, int) {
  return std::make_unique<Painting>(phantomOf(values));
}

std::unique_ptr<Field> makePhantomLabels(const ParameterValues& values, int) {
  return std::make_unique<LabelPainting>(phantomOf(values));
}

std::unique_ptr<Field> makeBlastWave(const ParameterValues& values, int timeStep) {
  const BlastWaveSettings settings{wholeOf(values, kTimeSteps), values.number("instability"),
                                   values.number("front_width"), seedOf(values)};
  return std::make_unique<BlastWave>(settings, timeStep);
}

Parameter bandParameter(double value) {
  return Parameter::number("band", value, 0.001, 2, "",
                           "Distance from the surface at which the value reaches 0 or 1; the cube is 2 wide.");
}

std::vector<Generator> makeTable() {
  const std::vector<Parameter> phantom = {
      edgeWidthParameter(0.05),
      Parameter::integer("vessel_generations", 7, 0, 12, "", "Bifurcations from root to tip of a lung's vessels."),
      seedParameter()};
  return {
      {"marschner_lobb",
       {Parameter::number("f_m", 6, 0, 1000, "", "Frequency of the chirp, cycles per unit length."),
        Parameter::number("alpha", 0.25, 0, 10, "", "Amplitude of the chirp.")},
       makeMarschnerLobb},
      {"nested_ellipsoids",
       {edgeWidthParameter(0.05),
        Parameter::number("bone_thickness", 0.08, 0.02, 0.2, "", "Thickness of the skull; the cube is 2 wide.")},
       makeNestedEllipsoids},
      {"sphere",
       {Parameter::number("radius", 0.7, 0.01, 1, "", "Radius; the cube is 2 wide."), bandParameter(0.4)},
       makeSphere},
      {"torus",
       {Parameter::number("major_radius", 0.6, 0.3, 0.7, "", "From the axis to the middle of the tube."),
        Parameter::number("minor_radius", 0.25, 0.01, 0.3, "", "Of the tube."), bandParameter(0.25)},
       makeTorus},
      {"gyroid",
       {Parameter::number("periods", 4, 0.5, 64, "", "Cells of the gyroid over the cube's width.")},
       makeGyroid},
      {"noise",
       {Parameter::number("beta", 3, 0, 10, "", "The power spectral density is |k|^-beta."),
        Parameter::integer("lowest_frequency", 1, 1, 8, "", "Shortest |k|, cycles over the cube's width."),
        Parameter::integer("highest_frequency", 16, 8, Noise::kMaximumFrequency, "",
                           "Longest |k|, cycles over the cube's width."),
        seedParameter()},
       makeNoise},
      {"vessel_tree",
       {Parameter::number("root_radius", 0.07, 0.01, 0.1, "", "Radius of the root branch; the cube is 2 wide."),
        Parameter::integer("generations", 10, 0, 14, "", "Bifurcations from root to tip."), edgeWidthParameter(0.1),
        seedParameter()},
       makeVesselTree},
      {"phantom", phantom, makePhantom},
      {"phantom_labels", phantom, makePhantomLabels, true},
      {"blast_wave",
       {Parameter::integer(kTimeSteps, 30, 1, 1000, "", "Time steps of the volume."),
        Parameter::number("instability", 0.3, 0, 0.35, "",
                          "Share of its radius by which the last front is off the sphere at most."),
        Parameter::number("front_width", 0.05, 0.001, 0.1, "",
                          "Over which the density falls from the front to the air; the cube is 2 wide."),
        seedParameter()},
       makeBlastWave},
  };
}

const std::vector<Generator>& generators() {
  static const std::vector<Generator> all = makeTable();
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

/// Settings hold numbers; a whole one is an integer too.
ParameterValue parameterValue(double number) {
  if (std::floor(number) == number && std::abs(number) < 1e15) return static_cast<std::int64_t>(number);
  return number;
}

ParameterValues parameterValues(const Generator& generator, const GeneratorSettings& settings) {
  ParameterValues values(generator.parameters);
  for (const auto& [name, number] : settings.parameters) {
    try {
      values.set(name, parameterValue(number));
    } catch (const InputError& error) {
      throw InputError(fmt::format("generator {}: {}", generator.name, error.what()));
    }
  }
  return values;
}

} // namespace

std::vector<std::string> generatorNames() {
  std::vector<std::string> names;
  for (const Generator& generator : generators())
    names.push_back(generator.name);
  return names;
}

const std::vector<ParameterDescriptor>& generatorParameters(const std::string& name) {
  return findGenerator(name).parameters;
}

void checkGenerator(const GeneratorSettings& settings) {
  parameterValues(findGenerator(settings.name), settings);
}

int timeStepsOf(const GeneratorSettings& settings) {
  const Generator& generator = findGenerator(settings.name);
  const ParameterValues values = parameterValues(generator, settings);
  for (const ParameterDescriptor& parameter : generator.parameters)
    if (parameter.name == kTimeSteps) return wholeOf(values, kTimeSteps);
  return 1;
}

std::unique_ptr<Field> makeField(const GeneratorSettings& settings, int timeStep) {
  const Generator& generator = findGenerator(settings.name);
  return generator.make(parameterValues(generator, settings), timeStep);
}

double voxelUnit(const GeneratorSettings& settings) {
  if (findGenerator(settings.name).makesLabels) return 1;
  switch (settings.type) {
  case ScalarType::int8: return std::numeric_limits<std::int8_t>::max();
  case ScalarType::uint8: return std::numeric_limits<std::uint8_t>::max();
  case ScalarType::int16: return std::numeric_limits<std::int16_t>::max();
  case ScalarType::uint16: return std::numeric_limits<std::uint16_t>::max();
  case ScalarType::float32: return 1;
  }
  return 1;
}

} // namespace volmark
