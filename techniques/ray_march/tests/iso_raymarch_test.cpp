#include "iso_raymarch.h"
#include "parts/testing/session.h"
#include "reference/reference.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace volmark::ray_march {

using namespace parts;

namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 80;

/// How a picture's surface differs from the reference's.
struct SurfaceError {
  double within = 0;    ///< share of the pixels that both hit with a depth error of at most 0.05 voxel
  double mean = 0;      ///< depth, voxels, over the pixels that both hit
  double misplaced = 0; ///< share of all pixels: missed or spurious
  double colorMean = 0; ///< over the pixels within 0.05 voxel
  int hits = 0;
};

SurfaceError compare(const Picture& picture, const Picture& reference, double voxel) {
  SurfaceError error;
  int within = 0;
  int misplaced = 0;
  for (std::size_t i = 0; i < picture.distance.size(); ++i) {
    const bool hit = std::isfinite(picture.distance[i]);
    if (hit != std::isfinite(reference.distance[i])) ++misplaced;
    if (!hit || !std::isfinite(reference.distance[i])) continue;
    ++error.hits;
    const double difference = std::abs(picture.distance[i] - reference.distance[i]) / voxel;
    error.mean += difference;
    if (difference > 0.05) continue;
    ++within;
    const glm::vec4 color = glm::abs(picture.color[i] - reference.color[i]);
    error.colorMean += (color.r + color.g + color.b + color.a) / 4;
  }
  error.mean /= std::max(error.hits, 1);
  error.colorMean /= std::max(within, 1);
  error.within = double(within) / std::max(error.hits, 1);
  error.misplaced = double(misplaced) / static_cast<double>(picture.distance.size());
  return error;
}

SurfaceError errorOf(const Scene& scene, const FrameInputs& inputs,
                     const std::vector<std::pair<std::string, ParameterValue>>& values) {
  const Drawn drawn = drawOnce(isoRaymarch(), scene, inputs, kWidth, kHeight, values);
  const Picture reference = reference::renderIsosurface(scene, inputs, 0, kWidth, kHeight);
  return compare(drawn.pictures[0], reference, scene.volume->grid().smallestSpacingMm());
}

Scene rippleScene(ShadingModel shading = ShadingModel::lambert) {
  return makeScene(makeVolume(ripples, {64, 60, 56}, ScalarType::float32), shading);
}

FrameInputs inputsFor(const Scene& scene, double isovalue = 0.5) {
  return makeInputs(lookAtBox(scene.volume->grid(), 33, 21, kWidth, kHeight), isovalue);
}

class IsoScalarTypes : public testing::TestWithParam<ScalarType> {};

TEST_P(IsoScalarTypes, MatchTheReferenceInAnisotropicVolumes) {
  const Scene scene = makeScene(makeVolume(ripples, {64, 48, 40}, GetParam(), {0.8, 1.1, 1.4}), ShadingModel::lambert);
  for (const char* filtering : {"hardware", "shader"}) {
    const SurfaceError error = errorOf(scene, inputsFor(scene), {{"filtering", std::string(filtering)}});
    EXPECT_GT(error.hits, 1200);
    EXPECT_LT(error.misplaced, 0.002) << filtering;
    EXPECT_LT(error.colorMean, 0.005) << filtering;
    // Hardware may interpolate 8-bit voxels in 8 bits: the surface moves where the gradient is small.
    if (sizeOf(GetParam()) == 1 && filtering == std::string("hardware")) {
      EXPECT_LT(error.mean, 0.2);
    } else {
      EXPECT_GE(error.within, 0.995) << filtering;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, IsoScalarTypes,
                         testing::Values(ScalarType::int8, ScalarType::uint8, ScalarType::int16, ScalarType::uint16,
                                         ScalarType::float32),
                         [](const auto& type) { return std::string(nameOf(type.param)); });

TEST(IsoRaymarch, ErrorFallsWithTheStep) {
  const Scene scene = rippleScene();
  const FrameInputs inputs = inputsFor(scene, 0.47);
  const auto at = [&](double step) {
    return errorOf(scene, inputs, {{"step", step}, {"bisections", std::int64_t(0)}});
  };
  const SurfaceError coarse = at(4);
  const SurfaceError middle = at(1);
  const SurfaceError fine = at(0.125);
  // Without bisection the error is uniform in half a step; pixels solid at the entry have none.
  EXPECT_NEAR(coarse.mean, 4.0 / 4, 0.4);
  EXPECT_NEAR(middle.mean, 1.0 / 4, 0.1);
  EXPECT_NEAR(fine.mean, 0.125 / 4, 0.0125);
  EXPECT_GT(coarse.misplaced, fine.misplaced);
}

TEST(IsoRaymarch, EachBisectionHalvesTheError) {
  const Scene scene = rippleScene();
  const FrameInputs inputs = inputsFor(scene);
  double previous = 0.25;
  for (const std::int64_t bisections : {1, 2, 3, 4}) {
    const double mean = errorOf(scene, inputs, {{"step", 1.0}, {"bisections", bisections}}).mean;
    EXPECT_NEAR(mean / previous, 0.5, 0.15) << bisections;
    previous = mean;
  }
}

TEST(IsoRaymarch, ShadesAsTheReference) {
  for (const ShadingModel model :
       {ShadingModel::none, ShadingModel::lambert, ShadingModel::phong, ShadingModel::gooch, ShadingModel::ggx}) {
    const Scene scene = rippleScene(model);
    FrameInputs inputs = inputsFor(scene);
    inputs.light = {.headlight = false,
                    .direction = glm::normalize(glm::dvec3(0.3, 0.8, 0.6)),
                    .color = {1.0, 0.9, 0.7},
                    .ambient = 0.2};
    EXPECT_LT(errorOf(scene, inputs, {}).colorMean, 0.003) << int(model);
  }
}

TEST(IsoRaymarch, SolidAtTheEntryShowsTheSideOfTheBox) {
  const Scene scene = rippleScene();
  FrameInputs inputs = inputsFor(scene, 0.0);
  inputs.light.headlight = false;
  inputs.light.direction = glm::normalize(glm::dvec3(0.5, 0.7, 0.4));
  const Drawn drawn = drawOnce(isoRaymarch(), scene, inputs, kWidth, kHeight, {});
  const Picture reference = reference::renderIsosurface(scene, inputs, 0, kWidth, kHeight);
  const SurfaceError error = compare(drawn.pictures[0], reference, 1);
  EXPECT_EQ(error.misplaced, 0);
  EXPECT_LT(error.mean, 1e-3);
  EXPECT_LT(error.colorMean, 1e-3);
}

TEST(IsoRaymarch, ClippingPlanesShowTheCut) {
  const Scene scene = makeScene(makeVolume(ball, glm::ivec3(64), ScalarType::uint16), ShadingModel::lambert);
  FrameInputs inputs = inputsFor(scene, 0.3);
  inputs.light.headlight = false;
  inputs.light.direction = {0, 1, 0};
  inputs.clippingPlanes = {{glm::normalize(glm::dvec3(-0.6, -0.3, -1)), -4.0}, {{0, -1, 0}, -10.0}};
  const SurfaceError error = errorOf(scene, inputs, {});
  EXPECT_GT(error.hits, 350);
  EXPECT_GE(error.within, 0.995);
  EXPECT_LT(error.misplaced, 0.002);
  EXPECT_LT(error.colorMean, 0.003);
  // The planes take a part of the ball away.
  FrameInputs whole = inputs;
  whole.clippingPlanes.clear();
  EXPECT_GT(errorOf(scene, whole, {}).hits, error.hits + 50);
}

TEST(IsoRaymarch, FollowsOffAxisFrusta) {
  const Scene scene = rippleScene();
  FrameInputs inputs = inputsFor(scene);
  inputs.views[0].frustum = {-0.1, 0.3, -0.25, 0.12};
  const SurfaceError error = errorOf(scene, inputs, {});
  EXPECT_GT(error.hits, 1200);
  EXPECT_GE(error.within, 0.995);
  EXPECT_LT(error.misplaced, 0.002);
}

TEST(IsoRaymarch, SeesFromInsideTheVolume) {
  const Scene scene = rippleScene();
  FrameInputs inputs = inputsFor(scene);
  inputs.views[0].pose = Pose::lookAt({5, -3, 20}, {-10, 5, -30});
  const SurfaceError error = errorOf(scene, inputs, {});
  EXPECT_GT(error.hits, 700);
  EXPECT_GE(error.within, 0.995);
  EXPECT_LT(error.misplaced, 0.004);
}

TEST(IsoRaymarch, DrawsVolumesOfOneVoxelAlongAnAxis) {
  const Scene scene = makeScene(makeVolume(ball, {40, 40, 1}, ScalarType::uint8), ShadingModel::lambert);
  const FrameInputs inputs = makeInputs(lookAtBox(scene.volume->grid(), 20, 15, kWidth, kHeight), 0.3);
  const SurfaceError error = errorOf(scene, inputs, {{"filtering", std::string("shader")}});
  EXPECT_GT(error.hits, 100);
  EXPECT_LT(error.misplaced, 0.002);
  EXPECT_LT(error.mean, 1e-3);
}

TEST(IsoRaymarch, BothEyesEqualTwoSinglePictures) {
  const Scene scene = rippleScene();
  FrameInputs inputs = inputsFor(scene);
  View right = inputs.views[0];
  right.pose.position += 6.0 * right.pose.right;
  right.layer = 1;
  FrameInputs stereo = inputs;
  stereo.views.push_back(right);
  for (const bool jitter : {false, true}) {
    const Drawn both = drawOnce(isoRaymarch(), scene, stereo, kWidth, kHeight, {{"jitter", jitter}});
    for (int view = 0; view < 2; ++view) {
      inputs.views[0] = stereo.views[view];
      inputs.views[0].layer = 0;
      const Drawn one = drawOnce(isoRaymarch(), scene, inputs, kWidth, kHeight, {{"jitter", jitter}});
      EXPECT_TRUE(identical(both.pictures[view], one.pictures[0])) << view;
    }
  }
}

TEST(IsoRaymarch, RepeatsAndCountsWithoutChangingThePicture) {
  const Scene scene = rippleScene();
  const FrameInputs inputs = inputsFor(scene);
  for (const bool jitter : {false, true}) {
    Session session(isoRaymarch(), scene, withParameters(isoRaymarch(), {{"jitter", jitter}}), {kWidth, kHeight, 1});
    const Picture first = session.draw(inputs).pictures[0];
    const Picture second = session.draw(inputs).pictures[0];
    session.reset();
    const Picture counted = session.draw(inputs, true).pictures[0];
    session.reset(2);
    const Picture reseeded = session.draw(inputs).pictures[0];
    EXPECT_TRUE(identical(first, counted));
    EXPECT_EQ(identical(first, second), !jitter);
    EXPECT_EQ(identical(first, reseeded), !jitter);
  }
}

TEST(IsoRaymarch, JitterKeepsTheSurface) {
  const Scene scene = rippleScene();
  const SurfaceError error = errorOf(scene, inputsFor(scene), {{"jitter", true}, {"bisections", std::int64_t(8)}});
  EXPECT_GE(error.within, 0.995);
  EXPECT_LT(error.misplaced, 0.002);
}

TEST(IsoRaymarch, CountsSamplesAsTheGeometrySays) {
  const Scene scene = rippleScene();
  const FrameInputs inputs = inputsFor(scene, 0.5);
  const Drawn drawn =
      drawOnce(isoRaymarch(), scene, inputs, kWidth, kHeight,
               {{"step", 0.5}, {"bisections", std::int64_t(5)}, {"filtering", std::string("shader")}}, true);
  const Picture surface = reference::renderIsosurface(scene, inputs, 0, kWidth, kHeight);
  std::uint64_t rays = 0;
  double hits = 0;
  double samples = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Ray ray = rayThroughPixel(inputs.views[0], x, y, kWidth, kHeight);
      const auto span = boxSpan(scene.volume->grid(), ray);
      if (!span) continue;
      ++rays;
      // The entry, whole steps up to the crossing or the exit, the bisections.
      const float distance = surface.distance[surface.index(x, y)];
      const double end = std::isfinite(distance) ? distance / ray.cosine : span->exit;
      samples += 1 + std::ceil((end - span->entry) / 0.5);
      if (std::isfinite(distance)) ++hits;
      if (std::isfinite(distance) && end > span->entry + 1e-3) samples += 5;
    }
  }
  EXPECT_EQ(drawn.counters.at("rays"), rays);
  EXPECT_NEAR(double(drawn.counters.at("hits")), hits, 0.002 * double(rays));
  EXPECT_NEAR(double(drawn.counters.at("samples")), samples, 0.003 * samples);
  EXPECT_LE(drawn.counters.at("gradients"), drawn.counters.at("hits"));
  EXPECT_GT(drawn.counters.at("gradients"), 700u);
}

// The normals of a ball are its radii, whatever the shading; one sum of steps is the counter.
TEST(IsoRaymarch, CountingFramesHaveNormalsAndSteps) {
  for (const ShadingModel shading : {ShadingModel::none, ShadingModel::lambert}) {
    const Scene scene = makeScene(makeVolume(ball, {48, 48, 48}, ScalarType::float32), shading);
    const FrameInputs inputs = inputsFor(scene, 0.4);
    const Drawn drawn = drawOnce(isoRaymarch(), scene, inputs, kWidth, kHeight, {}, true);
    const Picture& picture = drawn.pictures[0];
    ASSERT_EQ(picture.normal.size(), picture.color.size());
    double steps = 0;
    int hits = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const std::size_t pixel = picture.index(x, y);
        steps += picture.steps.at(pixel);
        const glm::dvec3 normal(picture.normal[pixel]);
        if (!std::isfinite(picture.distance[pixel])) {
          ASSERT_EQ(picture.normal[pixel], glm::vec3(0));
          continue;
        }
        ++hits;
        const Ray ray = rayThroughPixel(inputs.views[0], x, y, kWidth, kHeight);
        const glm::dvec3 place = ray.origin + picture.distance[pixel] / ray.cosine * ray.direction;
        ASSERT_NEAR(glm::length(normal), 1, 1e-5);
        ASSERT_GT(glm::dot(normal, glm::normalize(place)), 0.99);
      }
    }
    EXPECT_GT(hits, 500);
    EXPECT_EQ(steps, double(drawn.counters.at("samples")));
    if (shading == ShadingModel::none) {
      EXPECT_EQ(drawn.counters.at("gradients"), 0u);
    }
  }
}

TEST(IsoRaymarch, TimedFramesLeaveTheLayersAlone) {
  const Scene scene = rippleScene();
  Session session(isoRaymarch(), scene, withParameters(isoRaymarch(), {}), {kWidth, kHeight, 1});
  const Picture counted = session.draw(inputsFor(scene, 0.3), true).pictures[0];
  const Picture timed = session.draw(inputsFor(scene, 0.7)).pictures[0];
  EXPECT_FALSE(identical(counted, timed));
  EXPECT_EQ(counted.steps, timed.steps);
  EXPECT_EQ(counted.normal, timed.normal);
}

TEST(IsoRaymarch, SaysWhatMemoryItUses) {
  const Scene scene = rippleScene();
  const std::uint64_t before = device().ledger().totalBytes();
  {
    Session session(isoRaymarch(), scene, withParameters(isoRaymarch(), {}), {kWidth, kHeight, 1});
    std::uint64_t total = 0;
    for (const gpu::MemoryItem& item : session.technique().memory())
      total += item.bytes;
    EXPECT_EQ(total, session.preparedBytes());
    EXPECT_GE(total, 64u * 60 * 56 * 4);
  }
  EXPECT_EQ(device().ledger().totalBytes(), before);
}

TEST(IsoRaymarch, SaysWhyItCannotRun) {
  const Scene scene = rippleScene();
  const TechniqueFactory factory = isoRaymarch();
  const ParameterValues parameters = withParameters(factory, {});
  EXPECT_FALSE(factory.whyUnsupported(scene, parameters, {64, 64, 2}, &device()));
  EXPECT_THAT(factory.whyUnsupported(scene, parameters, {64, 64, 9}, &device()).value(), testing::HasSubstr("9 views"));
}

} // namespace
} // namespace volmark::ray_march
