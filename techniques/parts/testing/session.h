// Scenes, views and a small driver of one technique for the tests of this family.
#pragma once

#include "volmark/gpu/target.h"
#include "volmark/recorder.h"
#include "volmark/technique.h"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace volmark::parts {

/// Scalars in [0,1] by position, voxel i of n at (i+0.5)/n along each axis.
using ScalarField = std::function<double(const glm::dvec3&)>;

/// Marschner and Lobb's shape at a frequency that the grid holds, tilted so that no axis is special.
double ripples(const glm::dvec3& position);
/// 1 in the middle, 0 at distance 0.5.
double ball(const glm::dvec3& position);

/// A grid of voxels; integers use their type's whole range. `spacing` in mm.
std::shared_ptr<const Volume> makeVolume(const ScalarField& field, glm::ivec3 dims, ScalarType type,
                                         glm::dvec3 spacing = glm::dvec3(1));
Scene makeScene(std::shared_ptr<const Volume> volume, ShadingModel shading);
/// All of the box in view from a direction, in degrees.
View lookAtBox(const Grid& grid, double azimuth, double elevation, int width, int height);
/// One view, a smooth transfer function with a transparent beginning.
FrameInputs makeInputs(const View& view, double isovalue = 0.5, double topOpacity = 0.1);
std::shared_ptr<const TransferFunction> ramp(double topOpacity);

/// Records without timing anything.
class PlainRecorder final : public Recorder {
public:
  explicit PlainRecorder(gpu::Commands& commands) : m_commands(commands) {}
  gpu::Commands& gpu() override { return m_commands; }

protected:
  int beginGpuPass(std::string_view) override { return 0; }
  int beginHostPass(std::string_view) override { return 0; }
  void endPass(int) noexcept override {}

private:
  gpu::Commands& m_commands;
};

/// The one device of the tests, with validation.
gpu::Device& device();

/// What a frame left behind.
struct Drawn {
  std::vector<Picture> pictures;                 ///< one per view
  std::map<std::string, std::uint64_t> counters; ///< of counting frames, as the pictures' layers
};

/// One technique, prepared.
class Session {
public:
  Session(const TechniqueFactory& factory, const Scene& scene, const ParameterValues& parameters, OutputSize size);
  ~Session();

  void reset(std::uint64_t seed = 1);
  Drawn draw(const FrameInputs& inputs, bool counting = false);
  const Technique& technique() const { return *m_technique; }
  /// Added to the device's ledger by prepare.
  std::uint64_t preparedBytes() const { return m_preparedBytes; }
  /// And since then, too.
  std::uint64_t addedBytes() const { return device().ledger().totalBytes() - m_before; }

private:
  Scene m_scene;
  OutputSize m_size;
  ParameterValues m_parameters;
  gpu::Commands m_commands;
  std::unique_ptr<gpu::Target> m_target;
  std::unique_ptr<Technique> m_technique;
  std::shared_ptr<const TransferFunction> m_drawnFunction;
  std::uint64_t m_frame = 0;
  std::uint64_t m_before = 0; ///< the ledger's bytes without the technique
  std::uint64_t m_preparedBytes = 0;
};

/// Parameters of a technique with some of them set.
ParameterValues withParameters(const TechniqueFactory& factory,
                               const std::vector<std::pair<std::string, ParameterValue>>& values);

/// One frame of a fresh session.
Drawn drawOnce(const TechniqueFactory& factory, const Scene& scene, const FrameInputs& inputs, int width, int height,
               const std::vector<std::pair<std::string, ParameterValue>>& values, bool counting = false);

/// Where a ray is inside the box, in world units.
struct Span {
  double entry;
  double exit;
};
std::optional<Span> boxSpan(const Grid& grid, const Ray& ray);

/// Largest difference of any colour component or of opacity.
double largestDifference(const Picture& a, const Picture& b);
double meanDifference(const Picture& a, const Picture& b);
/// Bit for bit.
bool identical(const Picture& a, const Picture& b);

} // namespace volmark::parts
