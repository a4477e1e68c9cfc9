#include "volume/generators/noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace volmark::test {
namespace {

using Complex = std::complex<double>;

/// Power of each wave vector over one period of a noise volume.
class Spectrum {
public:
  /// `n` samples a side; wave vectors beyond n/2 would fold back.
  Spectrum(double beta, int lowest, int highest, int n) : m_size(n) {
    GeneratorSettings settings{.name = "noise", .dims = glm::ivec3(n + 1), .type = ScalarType::float32};
    settings.parameters = {{"beta", beta}, {"lowest_frequency", lowest}, {"highest_frequency", highest}, {"seed", 7}};
    const auto volume = generateVolume(settings);
    // The field repeats: the last voxel of a row is the first again.
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j) {
        EXPECT_NEAR(volume->value(n, j, k), volume->value(0, j, k), 1e-6);
        for (int i = 0; i < n; ++i)
          m_data.emplace_back(volume->value(i, j, k));
      }
    for (int axis = 0; axis < 3; ++axis)
      transformFastestAxis();
  }

  /// Components from -n/2 to n/2.
  double power(int kx, int ky, int kz) const {
    const auto wrapped = [&](int k) { return static_cast<std::size_t>((k + m_size) % m_size); };
    const auto n = static_cast<std::size_t>(m_size);
    return std::norm(m_data[(wrapped(kz) * n + wrapped(ky)) * n + wrapped(kx)] / std::pow(double(m_size), 3));
  }

private:
  /// Transforms along the fastest axis and turns the axes round: three times is the whole transform.
  void transformFastestAxis() {
    const auto n = static_cast<std::size_t>(m_size);
    std::vector<Complex> result(m_data.size());
    for (std::size_t row = 0; row < n * n; ++row)
      for (std::size_t k = 0; k < n; ++k) {
        Complex sum = 0;
        for (std::size_t i = 0; i < n; ++i)
          sum += m_data[row * n + i] * std::polar(1.0, -2 * std::numbers::pi * double(i * k % n) / double(n));
        result[k * n * n + row] = sum;
      }
    m_data = std::move(result);
  }

  int m_size;
  std::vector<Complex> m_data;
};

class NoiseSpectrum : public testing::TestWithParam<double> {};

INSTANTIATE_TEST_SUITE_P(Exponents, NoiseSpectrum, testing::Values(0, 2, 11.0 / 3));

TEST_P(NoiseSpectrum, IsThePowerLawWithinTheBandAndNothingOutside) {
  const double beta = GetParam();
  const int lowest = 3;
  const int highest = 9;
  const int half = 10;
  const Spectrum spectrum(beta, lowest, highest, 2 * half + 1);
  const double reference = spectrum.power(0, 0, lowest) * std::pow(lowest, beta);
  ASSERT_GT(reference, 1e-8);
  for (int kz = -half; kz <= half; ++kz)
    for (int ky = -half; ky <= half; ++ky)
      for (int kx = -half; kx <= half; ++kx) {
        const int squared = kx * kx + ky * ky + kz * kz;
        if (squared == 0) continue; // the mean
        const double found = spectrum.power(kx, ky, kz) / reference;
        const bool inBand = squared >= lowest * lowest && squared <= highest * highest;
        const double expected = inBand ? std::pow(squared, -beta / 2) : 0;
        // Rounding to float32 adds white noise of about 1e-7 of the longest wave.
        ASSERT_NEAR(std::sqrt(found), std::sqrt(expected), 1e-6) << kx << " " << ky << " " << kz;
      }
}

TEST(Noise, PhasesAreSpread) {
  // Independent phases add up to a normal distribution: its fourth moment is 3 squares of the second.
  const auto volume = generateVolume(
      {.name = "noise", .dims = glm::ivec3(33), .type = ScalarType::float32, .parameters = {{"beta", 0}, {"seed", 3}}});
  double mean = 0;
  double second = 0;
  double fourth = 0;
  const auto forEachVoxel = [&](auto visit) {
    for (int k = 0; k < 33; ++k)
      for (int j = 0; j < 33; ++j)
        for (int i = 0; i < 33; ++i)
          visit(volume->value(i, j, k), 1 / std::pow(33, 3));
  };
  forEachVoxel([&](double value, double weight) { mean += weight * value; });
  forEachVoxel([&](double value, double weight) {
    const double square = std::pow(value - mean, 2);
    second += weight * square;
    fourth += weight * square * square;
  });
  EXPECT_NEAR(fourth / (second * second), 3, 0.2);
}

TEST(Noise, AWiderBandKeepsItsWaves) {
  const Noise narrow(3, 1, 8, 1);
  const Noise wide(3, 1, 9, 1);
  double covariance = 0;
  double squareNarrow = 0;
  double squareWide = 0;
  for (double x = -1; x < 1; x += 0.05)
    for (double y = -1; y < 1; y += 0.05) {
      const double a = narrow.value({x, y, 0.1}) - narrow.value({x, y, 0.6});
      const double b = wide.value({x, y, 0.1}) - wide.value({x, y, 0.6});
      covariance += a * b;
      squareNarrow += a * a;
      squareWide += b * b;
    }
  EXPECT_GT(covariance / std::sqrt(squareNarrow * squareWide), 0.97);
}

} // namespace
} // namespace volmark::test
