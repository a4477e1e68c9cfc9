#include "volume/generators/phantom.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace volmark::test {
namespace {

constexpr int kSize = 96;

std::shared_ptr<const Volume> generate(const std::string& name, ScalarType type, double edgeWidth) {
  return generateVolume(
      {.name = name, .dims = glm::ivec3(kSize), .type = type, .parameters = {{"edge_width", edgeWidth}}});
}

template <class Visit> void forEachVoxel(Visit visit) {
  for (int k = 0; k < kSize; ++k)
    for (int j = 0; j < kSize; ++j)
      for (int i = 0; i < kSize; ++i)
        visit(i, j, k);
}

TEST(Phantom, HasAllTissues) {
  const auto labels = generate("phantom_labels", ScalarType::uint8, 0.03);
  std::array<double, 4> shares{};
  forEachVoxel([&](int i, int j, int k) {
    const double label = labels->value(i, j, k);
    ASSERT_TRUE(label == 0 || label == 1 || label == 2 || label == 3);
    shares[static_cast<std::size_t>(label)] += 1.0 / (kSize * kSize * kSize);
  });
  EXPECT_GT(shares[0], 0.5);
  EXPECT_GT(shares[1], 0.1);
  EXPECT_GT(shares[2], 0.01);
  EXPECT_GT(shares[3], 0.003);
}

TEST(Phantom, LabelsSayWhichPlateauAValueIsOn) {
  // Of narrow edges, of which few voxels are part.
  const auto values = generate("phantom", ScalarType::float32, 0.001);
  const auto labels = generate("phantom_labels", ScalarType::uint8, 0.001);
  std::array<double, 4> found{};
  std::array<double, 4> all{};
  forEachVoxel([&](int i, int j, int k) {
    const auto label = static_cast<std::size_t>(labels->value(i, j, k));
    all[label] += 1;
    const double plateau = plateauOf(static_cast<Tissue>(label));
    found[label] += std::abs(values->value(i, j, k) - plateau) < 1e-6 ? 1 : 0;
  });
  for (std::size_t label = 0; label < 4; ++label)
    EXPECT_GT(found[label] / all[label], 0.95) << label;
}

TEST(Phantom, LabelsDoNotDependOnTheEdges) {
  EXPECT_EQ(generate("phantom_labels", ScalarType::uint8, 0.001)->identity(),
            generate("phantom_labels", ScalarType::uint8, 0.05)->identity());
}

TEST(Phantom, FacesOfTheCubeAreAir) {
  const auto values = generate("phantom", ScalarType::float32, 0.05);
  double highest = 0;
  forEachVoxel([&](int i, int j, int k) {
    if (std::min({i, j, k}) == 0 || std::max({i, j, k}) == kSize - 1)
      highest = std::max(highest, values->value(i, j, k));
  });
  EXPECT_EQ(highest, plateauOf(Tissue::air));
}

} // namespace
} // namespace volmark::test
