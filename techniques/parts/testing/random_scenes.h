// Random volumes, transfer functions and views, equal on every machine.
#pragma once

#include "parts/testing/session.h"

#include <cstdint>
#include <memory>

namespace volmark::parts {

/// Uniform in [0,1), by a counter.
class Numbers {
public:
  explicit Numbers(std::uint64_t seed) : m_state(seed * 0x9e3779b97f4a7c15ull + 1) {}
  double unit();
  double between(double low, double high) { return low + (high - low) * unit(); }
  int integer(int low, int high) { return low + static_cast<int>(unit() * (high - low + 1)); } ///< inclusive

private:
  std::uint64_t m_state;
};

/// Smooth blobs on an even ground, with some noise in places: empty and full regions, steep and flat ones.
std::shared_ptr<const Volume> randomVolume(Numbers& numbers, glm::ivec3 dims, ScalarType type, glm::dvec3 spacing);

/// Patches of up to 128 labels.
std::shared_ptr<const Volume> randomLabels(Numbers& numbers, glm::ivec3 dims, glm::dvec3 spacing);

/// Each label by chance.
std::bitset<kMaximumSegments> randomSegments(Numbers& numbers);

/// One to four bands of opacity with gaps in between, some of them narrow, some with jumps.
std::shared_ptr<const TransferFunction> randomTransferFunction(Numbers& numbers);

/// Looks at the volume from somewhere, sometimes from inside.
View randomView(Numbers& numbers, const Grid& grid, int width, int height);

/// None, one or two planes through the volume.
std::vector<ClippingPlane> randomPlanes(Numbers& numbers, const Grid& grid);

} // namespace volmark::parts
