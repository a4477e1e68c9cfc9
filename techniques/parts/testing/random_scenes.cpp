#include "parts/testing/random_scenes.h"

#include <algorithm>
#include <cmath>

namespace volmark::parts {

double Numbers::unit() {
  // SplitMix64.
  m_state += 0x9e3779b97f4a7c15ull;
  std::uint64_t z = m_state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

std::shared_ptr<const Volume> randomVolume(Numbers& numbers, glm::ivec3 dims, ScalarType type, glm::dvec3 spacing) {
  struct Blob {
    glm::dvec3 centre;
    double radius;
    double height;
  };
  std::vector<Blob> blobs(static_cast<std::size_t>(numbers.integer(2, 6)));
  for (Blob& blob : blobs)
    blob = {{numbers.unit(), numbers.unit(), numbers.unit()}, numbers.between(0.08, 0.35), numbers.between(0.2, 1)};
  const double ground = numbers.between(0, 0.4);
  const double noise = numbers.unit() < 0.4 ? numbers.between(0, 0.3) : 0;
  return makeVolume(
      [&](const glm::dvec3& position) {
        double value = ground;
        for (const Blob& blob : blobs) {
          const double share = 1 - glm::length(position - blob.centre) / blob.radius;
          if (share > 0) value = std::max(value, ground + (blob.height - ground) * std::min(1.0, 2 * share));
        }
        if (noise > 0 && position.x > 0.5) value += noise * (numbers.unit() - 0.5);
        return std::clamp(value, 0.0, 1.0);
      },
      dims, type, spacing);
}

std::shared_ptr<const Volume> randomLabels(Numbers& numbers, glm::ivec3 dims, glm::dvec3 spacing) {
  const int patches = numbers.integer(2, 5); // along each axis
  std::vector<std::byte> labels(static_cast<std::size_t>(patches) * patches * patches);
  for (std::byte& label : labels)
    label = static_cast<std::byte>(numbers.integer(0, kMaximumSegments - 1));
  std::vector<std::byte> voxels;
  for (int z = 0; z < dims.z; ++z)
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x) {
        const glm::ivec3 patch = glm::ivec3(x, y, z) * patches / dims;
        voxels.push_back(labels[static_cast<std::size_t>((patch.z * patches + patch.y) * patches + patch.x)]);
      }
  return std::make_shared<const Volume>("labels", Grid{dims, spacing}, ScalarType::uint8, std::move(voxels));
}

std::bitset<kMaximumSegments> randomSegments(Numbers& numbers) {
  std::bitset<kMaximumSegments> segments;
  const double share = numbers.unit();
  for (std::size_t i = 0; i < segments.size(); ++i)
    segments[i] = numbers.unit() < share;
  return segments;
}

std::shared_ptr<const TransferFunction> randomTransferFunction(Numbers& numbers) {
  std::vector<double> ends(static_cast<std::size_t>(2 * numbers.integer(1, 4)));
  for (double& end : ends)
    end = numbers.unit();
  std::sort(ends.begin(), ends.end());
  std::vector<ControlPoint> points;
  for (std::size_t i = 0; i < ends.size(); i += 2) {
    const glm::dvec3 color(numbers.unit(), numbers.unit(), numbers.unit());
    const double opacity = numbers.unit() < 0.3 ? numbers.between(0.3, 1) : numbers.between(0.01, 0.2);
    const double low = ends[i];
    const double high = numbers.unit() < 0.2 ? std::min(low + 0.01, ends[i + 1]) : ends[i + 1];
    points.push_back({low, color, 0});
    if (numbers.unit() < 0.5) points.push_back({low, color, opacity});
    points.push_back({0.5 * (low + high), color, opacity});
    points.push_back({high, color, 0});
  }
  return std::make_shared<TransferFunction>("random", std::move(points));
}

View randomView(Numbers& numbers, const Grid& grid, int width, int height) {
  if (numbers.unit() < 0.25) {
    const auto inside = [&](double half) { return half * numbers.between(-0.9, 0.9); };
    const glm::dvec3 half = grid.boxMaximum();
    const glm::dvec3 eye(inside(half.x), inside(half.y), inside(half.z));
    const glm::dvec3 target = eye + glm::dvec3(numbers.unit() - 0.5, numbers.unit() - 0.5, numbers.unit() + 0.1);
    return {.pose = Pose::lookAt(eye, target), .frustum = Frustum::symmetric(70, width, height)};
  }
  if (numbers.unit() < 0.2) return lookAtBox(grid, 0, 0, width, height); // rays along an axis
  return lookAtBox(grid, numbers.between(0, 360), numbers.between(-80, 80), width, height);
}

std::vector<ClippingPlane> randomPlanes(Numbers& numbers, const Grid& grid) {
  std::vector<ClippingPlane> planes(static_cast<std::size_t>(numbers.unit() < 0.6 ? 0 : numbers.integer(1, 2)));
  for (ClippingPlane& plane : planes) {
    plane.normal =
        glm::normalize(glm::dvec3(numbers.unit() - 0.5, numbers.unit() - 0.5, numbers.unit() - 0.5) + glm::dvec3(1e-3));
    plane.offset = numbers.between(-0.4, 0.2) * grid.boundingRadiusMm();
  }
  return planes;
}

} // namespace volmark::parts
