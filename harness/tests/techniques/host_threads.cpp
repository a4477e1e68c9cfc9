#include "test_techniques.h"

#include <algorithm>
#include <cmath>
#include <thread>

namespace volmark::test {

namespace {

class HostThreads : public Technique {
public:
  void prepare(const Preparation& preparation, Recorder& recorder) override {
    const auto pass = recorder.hostPass("copy");
    m_scene = &preparation.scene;
    m_threads = static_cast<int>(preparation.parameters.integer("threads"));
    const Volume& volume = *m_scene->volume;
    const glm::ivec3 dims = volume.grid().dims;
    for (int k = 0; k < dims.z; ++k)
      for (int j = 0; j < dims.y; ++j)
        for (int i = 0; i < dims.x; ++i)
          m_values.push_back(static_cast<float>(m_scene->normalised(volume.value(i, j, k))));
  }

  void reset(std::uint64_t) override {}
  void update(const Changes&, const FrameInputs&, Recorder&) override {}

  void draw(const Frame& frame, Recorder& recorder) override {
    const auto pass = recorder.hostPass("project");
    for (std::size_t view = 0; view < frame.pictures->size(); ++view) {
      std::vector<std::jthread> threads;
      for (int first = 0; first < m_threads; ++first)
        threads.emplace_back([&, first] { drawRows((*frame.pictures)[view], frame, view, first); });
    }
  }

  std::vector<gpu::MemoryItem> memory() const override { return {{"values", m_values.size() * sizeof(float)}}; }

private:
  void drawRows(Picture& picture, const Frame& frame, std::size_t view, int first) const {
    for (int y = first; y < picture.height; y += m_threads) {
      for (int x = 0; x < picture.width; ++x) {
        const float value = project(rayThroughPixel(frame.inputs.views[view], x, y, picture.width, picture.height));
        picture.color[picture.index(x, y)] = glm::vec4(value, value, value, 1);
        picture.distance[picture.index(x, y)] = HUGE_VALF;
        if (frame.counting) picture.steps[picture.index(x, y)] = value;
      }
    }
  }

  /// Largest nearest voxel at steps of one voxel.
  float project(const Ray& ray) const {
    const Grid& grid = m_scene->volume->grid();
    const double step = grid.smallestSpacingMm();
    const double middle = glm::length(ray.origin);
    float largest = 0;
    for (double t = middle - grid.boundingRadiusMm(); t < middle + grid.boundingRadiusMm(); t += step) {
      const glm::ivec3 voxel(glm::round(grid.toVoxel(ray.origin + t * ray.direction)));
      if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(voxel, grid.dims))) continue;
      const auto index = (static_cast<std::size_t>(voxel.z) * grid.dims.y + voxel.y) * grid.dims.x + voxel.x;
      largest = std::max(largest, m_values[index]);
    }
    return largest;
  }

  const Scene* m_scene = nullptr;
  std::vector<float> m_values;
  int m_threads = 1;
};

} // namespace

TechniqueFactory hostThreadsFactory() {
  TechniqueInfo info;
  info.name = "test_host_threads";
  info.summary = "Maximum intensity projection on host threads, without a GPU";
  info.draws = Draws::both;
  info.needsGpu = false;
  info.shadings = {ShadingModel::none};
  info.parameters = {ParameterDescriptor::integer("threads", 2, 1, 64, "", "Host threads")};
  info.passes = {{"project", "all rows of all views"}};
  info.layers = {PictureLayer::steps}; // stands in: the value again
  info.generation = {{"copy", "normalises the voxels"}};
  return {info, []() -> std::unique_ptr<Technique> { return std::make_unique<HostThreads>(); }};
}

} // namespace volmark::test
