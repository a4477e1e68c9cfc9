#include "image/metrics.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace volmark {

namespace {

const glm::dvec3 kBlack(0);

Picture uniform(const glm::vec4& color, int width = 5, int height = 3) {
  Picture picture(width, height);
  std::fill(picture.color.begin(), picture.color.end(), color);
  return picture;
}

Picture randomPicture(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(-0.2f, 1.2f);
  Picture picture(16, 9);
  for (glm::vec4& color : picture.color)
    color = {value(random), value(random), value(random), value(random)};
  return picture;
}

/// Shown grey of a linear value, recovered from the error against black.
double shownGrey(float linear) {
  return std::sqrt(compareColor(uniform(glm::vec4(glm::vec3(linear), 1)), uniform({0, 0, 0, 1}), kBlack).mse);
}

} // namespace

TEST(CompareColor, EncodesAsSrgb) {
  EXPECT_NEAR(shownGrey(0), 0, 1e-12);
  EXPECT_NEAR(shownGrey(1), 1, 1e-12);
  EXPECT_NEAR(shownGrey(0.5f), 0.735356983052449, 1e-9);
  EXPECT_NEAR(shownGrey(0.2140411f), 0.5, 1e-6);
  EXPECT_NEAR(shownGrey(0.002f), 12.92 * 0.002, 1e-8);
  // Both branches meet.
  EXPECT_NEAR(shownGrey(0.0031308f), shownGrey(0.0031309f), 1e-5);
}

TEST(CompareColor, ConstantOffsetHasAClosedForm) {
  // Shown values in the linear branch: differences are 12.92 times the linear ones.
  const PictureErrors errors = compareColor(uniform({0.002f, 0.001f, 0, 1}), uniform({0.001f, 0.001f, 0, 1}), kBlack);
  const double expected = std::pow(12.92 * (double(0.002f) - double(0.001f)), 2) / 3;
  EXPECT_NEAR(errors.mse, expected, 1e-15);
  EXPECT_NEAR(errors.psnrDb.value(), 10 * std::log10(1 / expected), 1e-9);
  EXPECT_FALSE(errors.identical);
}

TEST(CompareColor, WorstErrorIsOne) {
  const PictureErrors errors = compareColor(uniform({5, 9, 2, 1}), uniform({-1, 0, 0, 1}), kBlack);
  EXPECT_DOUBLE_EQ(errors.mse, 1);
  EXPECT_NEAR(errors.psnrDb.value(), 0, 1e-12);
}

TEST(CompareColor, IdenticalPicturesHaveNoPsnr) {
  const Picture picture = randomPicture(1);
  const PictureErrors errors = compareColor(picture, picture, {0.2, 0.3, 0.4});
  EXPECT_EQ(errors.mse, 0);
  EXPECT_FALSE(errors.psnrDb);
  EXPECT_TRUE(errors.identical);
  EXPECT_EQ(errors.flip, 0);
  EXPECT_EQ(errors.flipHdr, 0);
  // Colours that show the same need not be the same.
  const PictureErrors same = compareColor(uniform({2, 2, 2, 1}), uniform({3, 3, 3, 1}), kBlack);
  EXPECT_EQ(same.mse, 0);
  EXPECT_FALSE(same.psnrDb);
  EXPECT_FALSE(same.identical);
}

TEST(CompareColor, IsSymmetric) {
  const Picture a = randomPicture(1);
  const Picture b = randomPicture(2);
  EXPECT_EQ(compareColor(a, b, {0.1, 0.5, 1}).mse, compareColor(b, a, {0.1, 0.5, 1}).mse);
}

TEST(CompareColor, BackgroundShowsThroughPremultipliedColour) {
  // Half-covered red over a blue background is (0.5, 0, 0.5).
  const PictureErrors errors =
      compareColor(uniform({0.5f, 0, 0, 0.5f}), uniform({0.5f, 0, 0.5f, 1}), glm::dvec3(0, 0, 1));
  EXPECT_NEAR(errors.mse, 0, 1e-15);
  // Over black the missing half shows.
  const double shown = shownGrey(0.5f);
  EXPECT_NEAR(compareColor(uniform({0.5f, 0, 0, 0.5f}), uniform({0.5f, 0, 0.5f, 1}), kBlack).mse, shown * shown / 3,
              1e-12);
}

TEST(CompareColor, OnePixelCountsByItsShare) {
  Picture picture = uniform({0, 0, 0, 1}, 10, 10);
  picture.color[37] = {1, 1, 1, 1};
  EXPECT_NEAR(compareColor(picture, uniform({0, 0, 0, 1}, 10, 10), kBlack).mse, 0.01, 1e-15);
}

TEST(CompareColor, NotANumberIsAsWrongAsCanBe) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Picture broken = uniform({nan, nan, nan, 1}, 20, 20);
  const Picture grey = uniform({0.5f, 0.5f, 0.5f, 1}, 20, 20);
  for (const PictureErrors& errors : {compareColor(broken, grey, kBlack), compareColor(grey, broken, kBlack)}) {
    EXPECT_DOUBLE_EQ(errors.mse, 1);
    EXPECT_EQ(errors.ssim, 0);
    EXPECT_EQ(errors.flip, 1);
  }
  const PictureErrors alike = compareColor(broken, broken, kBlack);
  EXPECT_EQ(alike.mse, 0);
  EXPECT_EQ(alike.ssim, 1);
  EXPECT_EQ(alike.flip, 0);
}

// One pixel without a number is wrong itself and shows in the windows around it, no farther.
TEST(CompareColor, NotANumberStaysWhereItIs) {
  const Picture grey = uniform({0.2f, 0.2f, 0.2f, 1}, 40, 40);
  Picture broken = grey;
  broken.color[broken.index(20, 20)].g = std::numeric_limits<float>::quiet_NaN();
  const PictureErrors errors = compareColor(broken, grey, kBlack);
  EXPECT_NEAR(errors.mse, 1.0 / (3 * 40 * 40), 1e-12);
  EXPECT_LT(errors.ssim.value(), 1);
  EXPECT_GT(errors.ssim.value(), 1 - 121.0 / (3 * 30 * 30));
  EXPECT_GE(errors.flip, 1.0 / (40 * 40));
  EXPECT_LT(errors.flip, 21.0 * 21 / (40 * 40));
}

TEST(CompareColor, SsimIsOfShownColoursAndNeedsAWindow) {
  // sRGB-encoded, (2ab + C1) / (a^2 + b^2 + C1) in one channel of three; the others are alike.
  const double a = shownGrey(0.1f);
  const double b = shownGrey(0.6f);
  const PictureErrors errors =
      compareColor(uniform({0.1f, 0.3f, 0, 1}, 16, 16), uniform({0.6f, 0.3f, 0, 1}, 16, 16), kBlack);
  EXPECT_NEAR(errors.ssim.value(), (2 + (2 * a * b + 1e-4) / (a * a + b * b + 1e-4)) / 3, 1e-9);
  EXPECT_FALSE(compareColor(uniform({0, 0, 0, 1}, 10, 16), uniform({1, 1, 1, 1}, 10, 16), kBlack).ssim);
}

TEST(CompareColor, FlipIsOfClampedColoursOverTheBackground) {
  const Picture white = uniform({7, 9, 3, 1}, 20, 20);
  EXPECT_NEAR(compareColor(uniform({-1, 0, 0, 1}, 20, 20), white, kBlack).flip, 0.96737976, 1e-7);
  // Nothing over white is white.
  EXPECT_NEAR(compareColor(uniform({0, 0, 0, 0}, 20, 20), white, glm::dvec3(1)).flip, 0, 1e-12);
}

TEST(CompareColor, HdrFlipIsThereWhereColoursExceedOne) {
  const Picture dim = uniform({1, 0.5f, -1, 1}, 20, 20);
  const Picture bright = uniform({1.5f, 0.5f, -1, 1}, 20, 20);
  EXPECT_FALSE(compareColor(dim, uniform({0.5f, 0.5f, 0, 1}, 20, 20), kBlack).flipHdr);
  EXPECT_GT(compareColor(dim, bright, kBlack).flipHdr.value(), 0.01);
  EXPECT_GT(compareColor(bright, dim, kBlack).flipHdr.value(), 0.01);
  // Clamped there is no difference.
  EXPECT_EQ(compareColor(dim, bright, kBlack).flip, 0);
}

TEST(CompareDistance, CountsMissedAndSpurious) {
  // 8 reference hits of which 2 are missed, and 3 hits too many.
  Picture picture(4, 4);
  Picture reference(4, 4);
  for (std::size_t i = 0; i < 8; ++i)
    reference.distance[i] = 10;
  for (std::size_t i = 2; i < 11; ++i)
    picture.distance[i] = 10;
  PictureErrors errors;
  compareDistance(picture, reference, 1, errors);
  EXPECT_DOUBLE_EQ(errors.missedShare.value(), 0.25);
  EXPECT_DOUBLE_EQ(errors.spuriousShare.value(), 0.375);
  EXPECT_EQ(errors.depthMaxVoxels.value(), 0);
}

TEST(CompareDistance, DepthErrorsAreInVoxels) {
  // Errors of 0, 1, ..., 200 half millimetres, to either side, in voxels of 2 mm.
  Picture picture(201, 1);
  Picture reference(201, 1);
  for (int i = 0; i <= 200; ++i) {
    reference.distance[reference.index(i, 0)] = 500;
    picture.distance[picture.index(i, 0)] = 500 + 0.5f * static_cast<float>(i % 2 == 0 ? i : -i);
  }
  PictureErrors errors;
  compareDistance(picture, reference, 2, errors);
  EXPECT_DOUBLE_EQ(errors.depthMeanVoxels.value(), 25);
  EXPECT_DOUBLE_EQ(errors.depthP995Voxels.value(), 0.995 * 50);
  EXPECT_DOUBLE_EQ(errors.depthMaxVoxels.value(), 50);
}

TEST(CompareDistance, NothingToCompareIsAbsent) {
  Picture picture(3, 3);
  Picture reference(3, 3);
  PictureErrors errors;
  compareDistance(picture, reference, 1, errors);
  EXPECT_FALSE(errors.depthMeanVoxels || errors.depthP995Voxels || errors.depthMaxVoxels);
  EXPECT_FALSE(errors.missedShare || errors.spuriousShare);
  reference.distance[0] = 1;
  compareDistance(picture, reference, 1, errors);
  EXPECT_EQ(errors.missedShare.value(), 1);
  EXPECT_FALSE(errors.depthMeanVoxels);
}

} // namespace volmark
