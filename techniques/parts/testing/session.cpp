#include "parts/testing/session.h"

#include "volmark/gpu/commands.h"
#include "volmark/module.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace volmark::parts {

namespace {

template <class Voxel> void append(std::vector<std::byte>& bytes, double unit) {
  Voxel voxel;
  if constexpr (std::is_floating_point_v<Voxel>) {
    voxel = static_cast<Voxel>(unit);
  } else {
    using Limits = std::numeric_limits<Voxel>;
    voxel = static_cast<Voxel>(std::lround(Limits::min() + unit * (double(Limits::max()) - Limits::min())));
  }
  const auto* begin = reinterpret_cast<const std::byte*>(&voxel);
  bytes.insert(bytes.end(), begin, begin + sizeof(Voxel));
}

void append(std::vector<std::byte>& bytes, ScalarType type, double unit) {
  switch (type) {
  case ScalarType::int8: return append<std::int8_t>(bytes, unit);
  case ScalarType::uint8: return append<std::uint8_t>(bytes, unit);
  case ScalarType::int16: return append<std::int16_t>(bytes, unit);
  case ScalarType::uint16: return append<std::uint16_t>(bytes, unit);
  case ScalarType::float32: return append<float>(bytes, unit);
  }
}

/// Fails the run if the validation layer had anything to say.
class NoValidationMessages final : public testing::Environment {
public:
  void TearDown() override { EXPECT_THAT(device().validationMessages(), testing::IsEmpty()); }
};
const testing::Environment* const kNoValidationMessages = testing::AddGlobalTestEnvironment(new NoValidationMessages);

} // namespace

double ripples(const glm::dvec3& position) {
  const glm::dvec3 p = 2.0 * position - 1.0 + glm::dvec3(0.07, -0.05, 0.03);
  const double r = std::hypot(p.x, p.y);
  const double wave = std::cos(2 * std::numbers::pi * 1.5 * std::cos(std::numbers::pi * r / 2));
  const double value = (1 - std::sin(std::numbers::pi * p.z / 2) + 0.25 * (1 + wave)) / 2.5;
  return std::clamp(value, 0.0, 1.0);
}

double ball(const glm::dvec3& position) {
  return std::clamp(1 - 2 * glm::length(position - 0.5), 0.0, 1.0);
}

std::shared_ptr<const Volume> makeVolume(const ScalarField& field, glm::ivec3 dims, ScalarType type,
                                         glm::dvec3 spacing) {
  std::vector<std::byte> bytes;
  for (int k = 0; k < dims.z; ++k)
    for (int j = 0; j < dims.y; ++j)
      for (int i = 0; i < dims.x; ++i)
        append(bytes, type, field((glm::dvec3(i, j, k) + 0.5) / glm::dvec3(dims)));
  return std::make_shared<Volume>("test", Grid{dims, spacing}, type, std::move(bytes));
}

Scene makeScene(std::shared_ptr<const Volume> volume, ShadingModel shading) {
  const Range range = volume->dataRange();
  return {.name = "test", .volume = std::move(volume), .visualisationRange = range, .shading = {.model = shading}};
}

View lookAtBox(const Grid& grid, double azimuth, double elevation, int width, int height) {
  const double a = glm::radians(azimuth);
  const double e = glm::radians(elevation);
  const double distance = grid.boundingRadiusMm() / std::sin(glm::radians(15.0));
  const glm::dvec3 direction(std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e));
  return {.pose = Pose::lookAt(distance * direction, glm::dvec3(0)), .frustum = Frustum::symmetric(30, width, height)};
}

std::shared_ptr<const TransferFunction> ramp(double topOpacity) {
  return std::make_shared<TransferFunction>("ramp", std::vector<ControlPoint>{{0.2, {0.1, 0.2, 0.8}, 0},
                                                                              {0.6, {0.9, 0.3, 0.1}, 0.5 * topOpacity},
                                                                              {1.0, {1.0, 0.8, 0.3}, topOpacity}});
}

FrameInputs makeInputs(const View& view, double isovalue, double topOpacity) {
  return {.views = {view}, .isovalue = isovalue, .transferFunction = ramp(topOpacity)};
}

gpu::Device& device() {
  static gpu::Device instance(gpu::DeviceOptions{.validate = true});
  return instance;
}

Session::Session(const TechniqueFactory& factory, const Scene& scene, const ParameterValues& parameters,
                 OutputSize size)
    : m_scene(scene), m_size(size), m_parameters(parameters), m_commands(device()) {
  static const bool registered = (gpu::registerShaders(volmarkModule()->shaders), true);
  static_cast<void>(registered);
  m_target = std::make_unique<gpu::Target>(device(), size.width, size.height, size.views, factory.info.layers);
  m_technique = factory.create();
  m_before = device().ledger().totalBytes();
  PlainRecorder recorder(m_commands);
  m_commands.begin();
  m_target->initialise(m_commands);
  m_technique->prepare({.scene = m_scene, .parameters = m_parameters, .size = size, .device = &device()}, recorder);
  m_commands.submit();
  m_commands.wait();
  m_preparedBytes = addedBytes();
  reset();
}

Session::~Session() {
  device().waitIdle();
}

void Session::reset(std::uint64_t seed) {
  m_technique->reset(seed);
  m_frame = 0;
}

Drawn Session::draw(const FrameInputs& inputs, bool counting) {
  PlainRecorder recorder(m_commands);
  m_commands.begin();
  // Nothing else of the inputs matters to update() here; rebuilding a table takes long.
  Changes changes;
  changes.transferFunction = m_drawnFunction != inputs.transferFunction;
  m_drawnFunction = inputs.transferFunction;
  m_technique->update(changes, inputs, recorder);
  const Frame frame{.index = m_frame++, .inputs = inputs, .counting = counting, .target = m_target.get()};
  m_technique->draw(frame, recorder);
  m_commands.submit();
  m_commands.wait();
  Drawn drawn;
  for (int view = 0; view < m_size.views; ++view)
    drawn.pictures.push_back(readBack(device(), *m_target, view));
  for (int view = 0; view < m_size.views; ++view)
    readBackLayers(device(), *m_target, view, drawn.pictures[static_cast<std::size_t>(view)]);
  if (counting)
    for (const CounterValue& counter : m_technique->counters())
      drawn.counters[counter.name] = counter.value;
  return drawn;
}

ParameterValues withParameters(const TechniqueFactory& factory,
                               const std::vector<std::pair<std::string, ParameterValue>>& values) {
  ParameterValues parameters(factory.info.parameters);
  for (const auto& [name, value] : values)
    parameters.set(name, value);
  return parameters;
}

Drawn drawOnce(const TechniqueFactory& factory, const Scene& scene, const FrameInputs& inputs, int width, int height,
               const std::vector<std::pair<std::string, ParameterValue>>& values, bool counting) {
  const OutputSize size{width, height, static_cast<int>(inputs.views.size())};
  return Session(factory, scene, withParameters(factory, values), size).draw(inputs, counting);
}

std::optional<Span> boxSpan(const Grid& grid, const Ray& ray) {
  const glm::dvec3 a = (grid.boxMinimum() - ray.origin) / ray.direction;
  const glm::dvec3 b = (grid.boxMaximum() - ray.origin) / ray.direction;
  const glm::dvec3 low = glm::min(a, b);
  const glm::dvec3 high = glm::max(a, b);
  const Span span{std::max({low.x, low.y, low.z, 0.0}), std::min({high.x, high.y, high.z})};
  if (span.entry > span.exit) return std::nullopt;
  return span;
}

double largestDifference(const Picture& a, const Picture& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.color.size(); ++i)
    for (int c = 0; c < 4; ++c)
      largest = std::max(largest, double(std::abs(a.color[i][c] - b.color[i][c])));
  return largest;
}

double meanDifference(const Picture& a, const Picture& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.color.size(); ++i)
    for (int c = 0; c < 4; ++c)
      sum += std::abs(a.color[i][c] - b.color[i][c]);
  return sum / (4.0 * static_cast<double>(a.color.size()));
}

bool identical(const Picture& a, const Picture& b) {
  return a.color.size() == b.color.size() &&
         std::memcmp(a.color.data(), b.color.data(), a.color.size() * sizeof(glm::vec4)) == 0 &&
         std::memcmp(a.distance.data(), b.distance.data(), a.distance.size() * sizeof(float)) == 0;
}

} // namespace volmark::parts
