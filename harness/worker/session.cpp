#include "worker/session.h"

#include "measure/clocks.h"
#include "volmark/error.h"

#include <fmt/format.h>

#include <cassert>

namespace volmark {

namespace {

void refuseUnsupported(const PointSettings& settings, const TechniqueFactory& factory, const Scene& scene,
                       const OutputSize& size, const gpu::Device* device) {
  if (size.views > factory.info.maximumViews)
    throw UnsupportedError(fmt::format("{} draws at most {} view(s), {} asked for", factory.info.name,
                                       factory.info.maximumViews, size.views));
  if (!factory.whyUnsupported) return;
  if (const auto why = factory.whyUnsupported(scene, settings.parameters, size, device)) throw UnsupportedError(*why);
}

Picture withLayers(Picture picture, const TechniqueInfo& info) {
  for (const PictureLayer layer : info.layers) {
    if (layer == PictureLayer::normal) picture.normal.resize(picture.color.size());
    if (layer == PictureLayer::steps) picture.steps.resize(picture.color.size());
  }
  return picture;
}

} // namespace

Session::Session(const PointSettings& settings, const CatalogueEntry& technique, std::shared_ptr<const Volume> volume,
                 const SessionOptions& options)
    : m_settings(settings), m_entry(technique), m_scene(makeScene(settings, std::move(volume))),
      m_timeline(settings, m_scene) {
  const OutputSize size{settings.width, settings.height, settings.stereo.enabled ? 2 : 1};
  if (info().needsGpu) m_device = std::make_unique<gpu::Device>(gpu::DeviceOptions{options.device, options.validate});
  refuseUnsupported(m_settings, *m_entry.factory, m_scene, size, m_device.get());
  if (m_device) {
    m_target = std::make_unique<gpu::Target>(*m_device, size.width, size.height, size.views, info().layers);
    m_outputBytes = m_device->ledger().totalBytes();
    for (int i = 0; i < settings.measure.framesInFlight; ++i)
      m_slots.push_back(makeGpuSlot(*m_device));
  } else {
    m_pictures.assign(static_cast<std::size_t>(size.views), withLayers(Picture(size.width, size.height), info()));
    m_slots.push_back(makeHostSlot());
  }
  m_technique = m_entry.factory->create();
}

Session::~Session() {
  if (m_device) m_device->waitIdle();
}

std::uint64_t Session::close() {
  if (m_device) m_device->waitIdle();
  m_technique.reset();
  m_slots.clear();
  m_target.reset();
  return m_device ? m_device->ledger().totalBytes() : 0;
}

std::uint64_t Session::techniqueBytes() const {
  return m_device ? m_device->ledger().totalBytes() - m_outputBytes : 0;
}

FrameTimes Session::prepare() {
  FrameSlot& slot = *m_slots.front();
  slot.begin(StampMode::breakdown);
  if (m_target) m_target->initialise(slot.recorder().gpu());
  const OutputSize size{m_settings.width, m_settings.height, m_settings.stereo.enabled ? 2 : 1};
  m_technique->prepare(Preparation{m_scene, m_settings.parameters, size, m_device.get()}, slot.recorder());
  slot.updateDone();
  slot.submit();
  FrameTimes times = slot.finish();
  if (m_device) slot.recorder().gpu().clearUploads();
  return times;
}

void Session::reset() {
  assert(m_unfinished.empty());
  m_technique->reset(m_settings.measure.seed);
  m_previousPhase.reset();
}

void Session::submit(double phase, std::uint64_t index, StampMode mode, bool counting) {
  assert(m_unfinished.size() < m_slots.size());
  FrameSlot& slot = *m_slots[m_nextSlot];
  const Changes changes = m_previousPhase ? m_timeline.between(*m_previousPhase, phase) : Changes{};
  const FrameInputs inputs = m_timeline.at(phase);

  m_unfinished.push_back({m_nextSlot, phase, monotonicMs(), processCpuMs()});
  slot.begin(mode);
  m_technique->update(changes, inputs, slot.recorder());
  slot.updateDone();
  m_technique->draw(Frame{index, inputs, counting, m_target.get(), m_target ? nullptr : &m_pictures}, slot.recorder());
  slot.submit();

  m_previousPhase = phase;
  m_nextSlot = (m_nextSlot + 1) % m_slots.size();
}

CompletedFrame Session::complete() {
  assert(!m_unfinished.empty());
  const Unfinished oldest = m_unfinished.front();
  m_unfinished.pop_front();
  CompletedFrame frame;
  frame.times = m_slots[oldest.slot]->finish();
  m_waste.spend(monotonicMs() - oldest.startMs, processCpuMs() - oldest.startCpuMs);
  frame.endMs = monotonicMs();
  frame.phase = oldest.phase;
  frame.startMs = oldest.startMs;
  return frame;
}

std::vector<Picture> Session::pictures() const {
  assert(m_unfinished.empty());
  std::vector<Picture> result = m_pictures;
  for (Picture& picture : result) {
    picture.normal.clear();
    picture.steps.clear();
  }
  for (int view = 0; m_target && view < m_target->views; ++view)
    result.push_back(gpu::readBack(*m_device, *m_target, view));
  return result;
}

void Session::addLayers(std::vector<Picture>& pictures) const {
  assert(m_unfinished.empty());
  for (std::size_t view = 0; view < pictures.size(); ++view) {
    if (m_target) {
      gpu::readBackLayers(*m_device, *m_target, static_cast<int>(view), pictures[view]);
    } else {
      pictures[view].normal = m_pictures[view].normal;
      pictures[view].steps = m_pictures[view].steps;
    }
  }
}

} // namespace volmark
