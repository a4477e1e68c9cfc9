#include "brick_boxes.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>

namespace volmark::empty_space_skipping {

namespace {

/// Bits of x, y, z in turn.
std::uint64_t mortonCode(const glm::ivec3& place) {
  std::uint64_t code = 0;
  for (int bit = 0; bit < 20; ++bit)
    for (int axis = 0; axis < 3; ++axis)
      code |= static_cast<std::uint64_t>((place[axis] >> bit) & 1) << (3 * bit + axis);
  return code;
}

std::uint64_t brickCount(const StructureSettings& settings, const Grid& grid) {
  const glm::ivec3 bricks = parts::blocksOf(cellsOf(grid, false), glm::ivec3(settings.blockEdge));
  return static_cast<std::uint64_t>(bricks.x) * bricks.y * bricks.z;
}

} // namespace

std::optional<std::string> whyBrickBoxesUnsupported(const StructureSettings& settings, const Volume& volume,
                                                    const gpu::Device& device) {
  if (!device.facts().rayQuery) return "The device has no ray queries (VK_KHR_ray_query).";
  const std::uint64_t bricks = brickCount(settings, volume.grid());
  const std::uint64_t most =
      std::min<std::uint64_t>(BoxTree::mostBoxes(device), device.facts().maximumStorageBufferRange / sizeof(BrickBox));
  if (bricks > most)
    return fmt::format("The volume has {} bricks of {} voxels, the device allows {} boxes.", bricks, settings.blockEdge,
                       most);
  return std::nullopt;
}

BrickBoxes::BrickBoxes(gpu::Device& device, const Scene& scene, const StructureSettings& settings)
    : m_scene(scene), m_settings(settings),
      m_tree(device, static_cast<std::uint32_t>(brickCount(settings, scene.volume->grid()))) {
  const glm::ivec3 bricks = parts::blocksOf(cellsOf(scene.volume->grid(), false), glm::ivec3(settings.blockEdge));
  for (int z = 0; z < bricks.z; ++z)
    for (int y = 0; y < bricks.y; ++y)
      for (int x = 0; x < bricks.x; ++x)
        m_bricks.push_back({.place = {x, y, z}, .low = 0, .high = 1});
  std::sort(m_bricks.begin(), m_bricks.end(),
            [](const Brick& a, const Brick& b) { return mortonCode(a.place) < mortonCode(b.place); });
  findRanges(0);
}

void BrickBoxes::findRanges(int timeStep) {
  const Volume& volume = *m_scene.volume;
  for (Brick& brick : m_bricks) {
    const glm::ivec3 first = brick.place * m_settings.blockEdge;
    const glm::ivec3 last = glm::min(first + m_settings.blockEdge, volume.grid().dims - 1);
    double low = std::numeric_limits<double>::max();
    double high = std::numeric_limits<double>::lowest();
    for (int z = first.z; z <= last.z; ++z)
      for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) {
          const double value = volume.value(x, y, z, timeStep);
          low = std::min(low, value);
          high = std::max(high, value);
        }
    brick.low = static_cast<float>(std::clamp(m_scene.normalised(low), 0.0, 1.0));
    brick.high = static_cast<float>(std::clamp(m_scene.normalised(high), 0.0, 1.0));
  }
  m_rangesOf = timeStep;
}

void BrickBoxes::prepareBuild(int timeStep, const VisibleScalars& visible) {
  if (m_rangesOf != timeStep) findRanges(timeStep);
  m_visible.clear();
  for (const Brick& brick : m_bricks) {
    if (!visible.anyBetween(brick.low, brick.high)) continue;
    const vec3 low(brick.place * m_settings.blockEdge);
    m_visible.push_back({low - kBoxMargin, low + static_cast<float>(m_settings.blockEdge) + kBoxMargin});
  }
}

void BrickBoxes::build(gpu::Commands& commands, const gpu::SampledImage&, const VisibleScalars&) {
  m_tree.build(commands, m_visible);
}

std::vector<gpu::Resource> BrickBoxes::resources() const {
  return {m_tree.structure(), m_tree.boxes()};
}

SkippingConstants BrickBoxes::constants(const VisibleScalars&, const VisibleScalars&) const {
  return {.blockShift = std::countr_zero(static_cast<unsigned>(m_settings.blockEdge))};
}

} // namespace volmark::empty_space_skipping
