// The interface of a technique: one way to draw a scene.
#pragma once

#include "volmark/gpu/memory_ledger.h"
#include "volmark/parameters.h"
#include "volmark/picture.h"
#include "volmark/recorder.h"
#include "volmark/scene.h"
#include "volmark/surface_mesh.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace volmark {

namespace gpu {
class Device;
struct Target;
} // namespace gpu

/// What is kept between frames.
enum class History : std::uint8_t {
  none,     ///< a frame depends on its inputs alone
  lossless, ///< state is kept, but the picture must not depend on it
  visible,  ///< the picture depends on earlier frames since reset()
};

enum class Draws : std::uint8_t { isosurface, volume, both };

/// How far a counter's value can be compared.
enum class CounterKind : std::uint8_t {
  exact,       ///< integers of structures: equal on every machine
  perDevice,   ///< along rays: floating point decides
  statistical, ///< depends on the order of threads or on random numbers
};

struct CounterDescriptor {
  std::string name; ///< snake_case; results column
  CounterKind kind = CounterKind::perDevice;
  std::string documentation;
};

struct PassDescriptor {
  std::string name; ///< snake_case; results column
  std::string documentation;
};

/// What a technique is, without an instance of it.
struct TechniqueInfo {
  std::string name;    ///< snake_case, unique over all modules
  std::string summary; ///< one line
  std::string paper;   ///< authors, title, year; empty if there is none
  std::string section; ///< where in the paper
  Draws draws = Draws::isosurface;
  History history = History::none;
  bool deterministic = true; ///< equal inputs give equal bits; else replays are repeated
  bool needsGpu = true;      ///< false: no Vulkan device is created; draws to Frame::pictures
  int maximumViews = 2;
  std::vector<ShadingModel> shadings; ///< supported models, the first one is the default
  bool shadows = false;               ///< draws Shading::shadows
  bool functionBeyond = false;        ///< draws Scene::functionBeyond
  bool segments = false;              ///< heeds FrameInputs::hiddenSegments
  std::vector<ParameterDescriptor> parameters;
  std::vector<PassDescriptor> passes;     ///< of update and draw
  std::vector<PassDescriptor> generation; ///< of prepare
  std::vector<CounterDescriptor> counters;
  std::vector<PictureLayer> layers; ///< written in counting frames, beside colour and distance
};

/// Size of the output.
struct OutputSize {
  int width = 0;
  int height = 0;
  int views = 1;
};

/// What prepare() is given. References stay valid as long as the technique lives.
struct Preparation {
  const Scene& scene;
  const ParameterValues& parameters;
  OutputSize size;
  gpu::Device* device = nullptr; ///< null if !needsGpu
};

/// One frame. Exactly one of target and pictures is set.
struct Frame {
  std::uint64_t index = 0; ///< since reset()
  const FrameInputs& inputs;
  bool counting = false; ///< a counting frame: fill counters() and TechniqueInfo::layers; never timed
  gpu::Target* target = nullptr;
  std::vector<Picture>* pictures = nullptr; ///< one per view, already of the right size; write every pixel
};

struct CounterValue {
  std::string name;
  std::uint64_t value = 0;
};

/// Lives on one thread. A technique never reads a clock: its work in a frame depends only on parameters,
/// inputs, seed and frame index. Order of calls: prepare, reset, then update and draw for each frame, in
/// pairs; reset may come again at any frame boundary.
class Technique {
public:
  virtual ~Technique() = default;

  /// Pipelines and static structures. Each step is a pass named in TechniqueInfo::generation. Throws
  /// UnsupportedError when the device can't hold it.
  virtual void prepare(const Preparation& preparation, Recorder& recorder) = 0;

  /// History is empty again; pipelines and static structures stay.
  virtual void reset(std::uint64_t seed) = 0;

  /// What changed since the last frame; may record passes. Timed as "update".
  virtual void update(const Changes& changes, const FrameInputs& inputs, Recorder& recorder) = 0;

  virtual void draw(const Frame& frame, Recorder& recorder) = 0;

  /// Work of the last counting frame, in the order of TechniqueInfo::counters. Called after it has finished.
  virtual std::vector<CounterValue> counters() const { return {}; }

  /// The surface that the last frame drew, of techniques that make a mesh of it; nothing otherwise. Not while a frame
  /// is pending; slow.
  virtual std::optional<SurfaceMesh> surface() const { return std::nullopt; }

  /// Device memory (host memory if !needsGpu) by resource. For GPU techniques the total equals what prepare,
  /// update and draw added to the device's ledger.
  virtual std::vector<gpu::MemoryItem> memory() const = 0;
};

/// How the harness makes techniques; one per technique in a module.
struct TechniqueFactory {
  TechniqueInfo info;
  std::unique_ptr<Technique> (*create)() = nullptr;
  /// Why this combination can't run (one sentence) or nothing. May be null. `device` is null if !needsGpu.
  std::optional<std::string> (*whyUnsupported)(const Scene& scene, const ParameterValues& parameters,
                                               const OutputSize& size, const gpu::Device* device) = nullptr;
};

} // namespace volmark
