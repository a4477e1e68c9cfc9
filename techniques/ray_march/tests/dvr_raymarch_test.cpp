#include "dvr_raymarch.h"
#include "parts/testing/session.h"
#include "reference/reference.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace volmark::ray_march {

using namespace parts;

namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 56;
constexpr double kOneOf255 = 1.0 / 255;

using Values = std::vector<std::pair<std::string, ParameterValue>>;
using Form = reference::VolumeSamples::Form;

Scene rippleScene(ShadingModel shading = ShadingModel::none) {
  return makeScene(makeVolume(ripples, {64, 60, 56}, ScalarType::float32), shading);
}

FrameInputs inputsFor(const Scene& scene, double topOpacity = 0.1) {
  return makeInputs(lookAtBox(scene.volume->grid(), 33, 21, kWidth, kHeight), 0.5, topOpacity);
}

Picture draw(const Scene& scene, const FrameInputs& inputs, const Values& values) {
  return drawOnce(dvrRaymarch(), scene, inputs, kWidth, kHeight, values).pictures[0];
}

Picture referenceOf(const Scene& scene, const FrameInputs& inputs, const reference::VolumeSamples& samples) {
  return reference::renderVolume(scene, inputs, 0, kWidth, kHeight, samples);
}

Values kind(const char* name, double step) {
  // Small tables are built fast; the control points of ramp() lie on the entries of this one.
  return {{"transfer_function_kind", std::string(name)},
          {"step", step},
          {"preintegrated_size", std::int64_t(101)},
          {"early_termination", false}};
}

class DvrScalarTypes : public testing::TestWithParam<ScalarType> {};

TEST_P(DvrScalarTypes, MatchTheReferenceSampleForSample) {
  const Scene scene = makeScene(makeVolume(ripples, {64, 48, 40}, GetParam(), {0.8, 1.1, 1.4}), ShadingModel::none);
  const FrameInputs inputs = inputsFor(scene);
  const Picture points = referenceOf(scene, inputs, {.form = Form::point, .stepVoxels = 0.7});
  const Picture slabs = referenceOf(scene, inputs, {.form = Form::preintegrated, .stepVoxels = 0.7});
  for (const char* filtering : {"hardware", "shader"}) {
    Values post = kind("post", 0.7);
    Values preintegrated = kind("preintegrated", 0.7);
    post.emplace_back("filtering", std::string(filtering));
    preintegrated.emplace_back("filtering", std::string(filtering));
    EXPECT_LT(largestDifference(draw(scene, inputs, post), points), kOneOf255) << filtering;
    EXPECT_LT(largestDifference(draw(scene, inputs, preintegrated), slabs), kOneOf255) << filtering;
  }
}

INSTANTIATE_TEST_SUITE_P(All, DvrScalarTypes,
                         testing::Values(ScalarType::int8, ScalarType::uint8, ScalarType::int16, ScalarType::uint16,
                                         ScalarType::float32),
                         [](const auto& type) { return std::string(nameOf(type.param)); });

class DvrSteps : public testing::TestWithParam<double> {};

TEST_P(DvrSteps, MatchTheReferenceAtEveryOpacity) {
  const Scene scene = rippleScene();
  for (const double topOpacity : {0.01, 0.1, 0.6, 0.95}) {
    const FrameInputs inputs = inputsFor(scene, topOpacity);
    const double step = GetParam();
    const Picture points = referenceOf(scene, inputs, {.form = Form::point, .stepVoxels = step});
    const Picture slabs = referenceOf(scene, inputs, {.form = Form::preintegrated, .stepVoxels = step});
    EXPECT_LT(largestDifference(draw(scene, inputs, kind("post", step)), points), kOneOf255) << topOpacity;
    EXPECT_LT(largestDifference(draw(scene, inputs, kind("preintegrated", step)), slabs), kOneOf255) << topOpacity;
  }
}

INSTANTIATE_TEST_SUITE_P(All, DvrSteps, testing::Values(0.25, 1.0, 2.5));

TEST(DvrRaymarch, OpaqueSlabsCutAtTheExitAreNotOpaque) {
  // A slab of 2.5 voxels of opacity 0.9999 is 1 in 32-bit floats, and so would be any part of it.
  const Scene scene = rippleScene();
  const FrameInputs inputs = inputsFor(scene, 1.0);
  const Picture slabs = referenceOf(scene, inputs, {.form = Form::preintegrated, .stepVoxels = 2.5});
  EXPECT_LT(largestDifference(draw(scene, inputs, kind("preintegrated", 2.5)), slabs), 0.05);
}

TEST(DvrRaymarch, ConvergesToTheIntegral) {
  const Scene scene = rippleScene();
  const FrameInputs inputs = inputsFor(scene, 0.3);
  const Picture integral = referenceOf(scene, inputs, {.form = Form::converged, .tolerance = 1e-4});
  for (const char* name : {"post", "preintegrated"}) {
    const double coarse = meanDifference(draw(scene, inputs, kind(name, 4)), integral);
    const double middle = meanDifference(draw(scene, inputs, kind(name, 1)), integral);
    const double fine = meanDifference(draw(scene, inputs, kind(name, 0.1)), integral);
    EXPECT_LT(middle, 0.5 * coarse) << name;
    // Half floats of the picture are what is left.
    EXPECT_LT(fine, std::max(0.5 * middle, 1e-4)) << name;
    EXPECT_LT(fine, 0.002) << name;
  }
}

TEST(DvrRaymarch, PreintegrationKeepsThinLayersAtLongSteps) {
  const Scene scene = rippleScene();
  FrameInputs inputs = inputsFor(scene);
  inputs.transferFunction = std::make_shared<TransferFunction>(
      "layer",
      std::vector<ControlPoint>{{0.48, {0.9, 0.5, 0.2}, 0}, {0.5, {0.9, 0.5, 0.2}, 0.8}, {0.52, {0.9, 0.5, 0.2}, 0}});
  const Picture integral = referenceOf(scene, inputs, {.form = Form::converged, .tolerance = 1e-3});
  const double post = meanDifference(draw(scene, inputs, kind("post", 2)), integral);
  const double preintegrated = meanDifference(draw(scene, inputs, kind("preintegrated", 2)), integral);
  EXPECT_LT(preintegrated, 0.3 * post);
}

TEST(DvrRaymarch, ShadesAsTheReference) {
  for (const ShadingModel model :
       {ShadingModel::lambert, ShadingModel::phong, ShadingModel::gooch, ShadingModel::ggx}) {
    const Scene scene = rippleScene(model);
    FrameInputs inputs = inputsFor(scene);
    inputs.light = {.headlight = false,
                    .direction = glm::normalize(glm::dvec3(0.3, 0.8, 0.6)),
                    .color = {1.0, 0.9, 0.7},
                    .ambient = 0.2};
    const Picture points = referenceOf(scene, inputs, {.form = Form::point, .stepVoxels = 0.7});
    const Picture slabs = referenceOf(scene, inputs, {.form = Form::preintegrated, .stepVoxels = 0.7});
    EXPECT_LT(largestDifference(draw(scene, inputs, kind("post", 0.7)), points), kOneOf255) << int(model);
    EXPECT_LT(largestDifference(draw(scene, inputs, kind("preintegrated", 0.7)), slabs), kOneOf255) << int(model);
  }
}

TEST(DvrRaymarch, ClippingPlanesAndOffAxisFrustaMatchTheReference) {
  const Scene scene = rippleScene();
  FrameInputs inputs = inputsFor(scene, 0.4);
  inputs.views[0].frustum = {-0.1, 0.3, -0.25, 0.12};
  inputs.clippingPlanes = {{glm::normalize(glm::dvec3(-0.6, -0.3, -1)), -4.0}, {{0, -1, 0}, -10.0}};
  const Picture points = referenceOf(scene, inputs, {.form = Form::point, .stepVoxels = 0.6});
  const Picture slabs = referenceOf(scene, inputs, {.form = Form::preintegrated, .stepVoxels = 0.6});
  EXPECT_LT(largestDifference(draw(scene, inputs, kind("post", 0.6)), points), kOneOf255);
  EXPECT_LT(largestDifference(draw(scene, inputs, kind("preintegrated", 0.6)), slabs), kOneOf255);
}

TEST(DvrRaymarch, BeyondClippingPlanesTheOtherFunctionHolds) {
  Scene scene = rippleScene(ShadingModel::lambert);
  scene.functionBeyond = std::make_shared<TransferFunction>(
      "beyond", std::vector<ControlPoint>{{0.3, {0.1, 0.9, 0.3}, 0.05}, {0.7, {0.9, 0.9, 0.1}, 0}});
  FrameInputs inputs = inputsFor(scene, 0.4);
  // Two that meet within the volume, and one that keeps nothing of many rays.
  for (const std::vector<ClippingPlane>& planes :
       {std::vector<ClippingPlane>{{glm::normalize(glm::dvec3(-0.6, -0.3, -1)), -4.0}, {{0, -1, 0}, -5.0}},
        std::vector<ClippingPlane>{{{1, 0, 0}, 6.0}}, std::vector<ClippingPlane>{}}) {
    inputs.clippingPlanes = planes;
    const Picture points = referenceOf(scene, inputs, {.form = Form::point, .stepVoxels = 0.6});
    const Picture slabs = referenceOf(scene, inputs, {.form = Form::preintegrated, .stepVoxels = 0.6});
    EXPECT_LT(largestDifference(draw(scene, inputs, kind("post", 0.6)), points), kOneOf255) << planes.size();
    EXPECT_LT(largestDifference(draw(scene, inputs, kind("preintegrated", 0.6)), slabs), kOneOf255) << planes.size();
  }
}

TEST(DvrRaymarch, HiddenSegmentsAreLeftOut) {
  Scene scene = rippleScene();
  const Grid& grid = scene.volume->grid();
  const auto labels = [](const glm::dvec3& p) {
    return std::floor(3 * p.x) + 3 * std::floor(3 * p.y) + 9 * std::floor(3 * p.z);
  };
  std::vector<std::byte> voxels;
  for (int z = 0; z < grid.dims.z; ++z)
    for (int y = 0; y < grid.dims.y; ++y)
      for (int x = 0; x < grid.dims.x; ++x)
        voxels.push_back(static_cast<std::byte>(labels((glm::dvec3(x, y, z) + 0.5) / glm::dvec3(grid.dims))));
  scene.volume = std::make_shared<const Volume>(
      scene.volume->withLabels(std::make_shared<const Volume>("labels", grid, ScalarType::uint8, std::move(voxels))));
  FrameInputs inputs = inputsFor(scene, 0.4);
  for (std::size_t label = 0; label < 27; label += 2)
    inputs.hiddenSegments.set(label);
  for (const char* filtering : {"hardware", "shader"}) {
    Values post = kind("post", 0.6);
    post.emplace_back("filtering", std::string(filtering));
    Values slabs = kind("preintegrated", 0.6);
    slabs.emplace_back("filtering", std::string(filtering));
    // A sample half-way between two voxels belongs to one or the other by rounding.
    EXPECT_LT(
        meanDifference(draw(scene, inputs, post), referenceOf(scene, inputs, {.form = Form::point, .stepVoxels = 0.6})),
        1e-4);
    EXPECT_LT(meanDifference(draw(scene, inputs, slabs),
                             referenceOf(scene, inputs, {.form = Form::preintegrated, .stepVoxels = 0.6})),
              1e-4);
  }
  // Showing all again needs no new session; hiding all leaves nothing.
  Session session(dvrRaymarch(), scene, withParameters(dvrRaymarch(), kind("post", 0.6)), {kWidth, kHeight, 1});
  inputs.hiddenSegments.set();
  EXPECT_EQ(session.draw(inputs, true).counters.at("visible_samples"), 0u);
  inputs.hiddenSegments.reset();
  EXPECT_LT(largestDifference(session.draw(inputs).pictures[0],
                              referenceOf(scene, inputs, {.form = Form::point, .stepVoxels = 0.6})),
            kOneOf255);
}

FrameInputs inSpotlight(FrameInputs inputs, const glm::dvec3& direction) {
  inputs.light = {.headlight = false, .direction = glm::normalize(direction), .spot = true, .ambient = 0};
  return inputs;
}

TEST(DvrRaymarch, ASpotlightShadesAsTheReference) {
  const Scene scene = rippleScene(ShadingModel::ggx);
  const FrameInputs inputs = inSpotlight(inputsFor(scene), {0.3, 0.8, 0.6});
  const Picture points = referenceOf(scene, inputs, {.form = Form::point, .stepVoxels = 0.7});
  EXPECT_LT(largestDifference(draw(scene, inputs, kind("post", 0.7)), points), kOneOf255);
}

TEST(DvrRaymarch, ShadowsAreTheReferencesButForTheirFewDepths) {
  Scene scene = rippleScene(ShadingModel::lambert);
  const FrameInputs inputs = inSpotlight(inputsFor(scene, 0.15), {0.3, 0.8, 0.6});
  for (const char* name : {"post", "preintegrated"}) {
    const Form form = name == std::string("post") ? Form::point : Form::preintegrated;
    Values values = kind(name, 0.5);
    values.emplace_back("shadow_bias", 0.0);
    values.emplace_back("shadow_resolution", std::int64_t(256));
    scene.shading.shadows = false;
    const Picture lit = draw(scene, inputs, values);
    scene.shading.shadows = true;
    const Picture expected = referenceOf(scene, inputs, {.form = form, .stepVoxels = 0.5});
    const Picture found = draw(scene, inputs, values);
    // The share that arrives is one of 0, 1/4 ... 1, at most 1/8 wrong, by chance either way; colours are at most 1.
    EXPECT_LT(largestDifference(found, expected), 1.0 / 8) << name;
    EXPECT_LT(meanDifference(found, expected), 0.1 * meanDifference(lit, expected)) << name;
  }
}

TEST(DvrRaymarch, CoarseShadowsAreInterpolatedBetweenTexels) {
  // The light fades towards one side only, smoothly: where it is looked up between the wrong texels, that shows.
  Scene scene = rippleScene(ShadingModel::lambert);
  scene.shading.shadows = true;
  const FrameInputs inputs = inSpotlight(inputsFor(scene, 0.15), {0.3, 0.8, 0.6});
  const auto at = [&](std::int64_t resolution) {
    Values values = kind("post", 0.5);
    values.emplace_back("shadow_bias", 0.0);
    values.emplace_back("shadow_resolution", resolution);
    return draw(scene, inputs, values);
  };
  const Picture fine = at(512);
  // 0.00091 here; 0.00130 with the weights of two texels swapped.
  const double coarse = meanDifference(at(32), fine);
  EXPECT_LT(coarse, 0.0011);
  EXPECT_LT(meanDifference(at(64), fine), 0.6 * coarse);
}

TEST(DvrRaymarch, AnOpaquePlateKeepsTheLightFromWhatIsBelow) {
  // A plate above the half of a floor, the light straight above, the eye aslant.
  const auto plateAndFloor = [](const glm::dvec3& p) {
    return p.y < 0.2 || (p.y > 0.7 && p.y < 0.8 && p.x < 0.5) ? 1.0 : 0.0;
  };
  Scene scene = makeScene(makeVolume(plateAndFloor, {48, 48, 48}, ScalarType::uint8), ShadingModel::lambert);
  scene.shading.shadows = true;
  FrameInputs inputs = inSpotlight(makeInputs(lookAtBox(scene.volume->grid(), 0, 30, kWidth, kHeight)), {0, 1, 0});
  inputs.light.distance = 50;
  inputs.transferFunction = std::make_shared<TransferFunction>(
      "opaque", std::vector<ControlPoint>{{0.4, glm::dvec3(1), 0}, {0.5, glm::dvec3(1), 0.9}});
  // Parallel rays nearly: what the eye sees of the floor, in the plate's shade and out of it.
  const glm::dvec3 half = scene.volume->grid().boxMaximum();
  const auto seenAt = [&](const glm::dvec3& world, const Picture& picture) {
    const View& view = inputs.views[0];
    const glm::dvec3 offset = world - view.pose.position;
    const double depth = glm::dot(offset, view.pose.forward);
    const double u = glm::dot(offset, view.pose.right) / depth;
    const double v = glm::dot(offset, view.pose.up) / depth;
    const Frustum& f = view.frustum;
    const int x = static_cast<int>((u - f.left) / (f.right - f.left) * kWidth);
    const int y = static_cast<int>((f.up - v) / (f.up - f.down) * kHeight);
    return picture.color[picture.index(x, y)];
  };
  Values values = kind("post", 0.5);
  values.emplace_back("shadow_resolution", std::int64_t(256));
  const Picture picture = draw(scene, inputs, values);
  const double floor = -0.6 * half.y;
  const glm::vec4 shaded = seenAt({-0.5 * half.x, floor, 0.6 * half.z}, picture);
  const glm::vec4 open = seenAt({0.5 * half.x, floor, 0.6 * half.z}, picture);
  EXPECT_GT(shaded.a, 0.98f);
  EXPECT_LT(shaded.r, 0.02f);
  EXPECT_GT(open.r, 0.9f);
}

TEST(DvrRaymarch, EarlyTerminationChangesNoMoreThanItAllows) {
  const Scene scene = rippleScene();
  const FrameInputs inputs = inputsFor(scene, 0.7);
  for (const char* name : {"post", "preintegrated"}) {
    const Values off = kind(name, 0.5);
    const Drawn whole = drawOnce(dvrRaymarch(), scene, inputs, kWidth, kHeight, off, true);
    EXPECT_EQ(whole.counters.at("terminated_rays"), 0u);
    for (const double opacity : {0.8, 0.99}) {
      Values on = off;
      on.emplace_back("early_termination", true);
      on.emplace_back("termination_opacity", opacity);
      const Drawn ended = drawOnce(dvrRaymarch(), scene, inputs, kWidth, kHeight, on, true);
      EXPECT_LE(largestDifference(ended.pictures[0], whole.pictures[0]), 1 - opacity + 1e-3);
      EXPECT_GT(ended.counters.at("terminated_rays"), 200u);
      EXPECT_LT(ended.counters.at("samples"), whole.counters.at("samples") * 9 / 10);
      // It ends at the very sample that reaches the opacity, as in the reference.
      const Picture reference = referenceOf(scene, inputs,
                                            {.form = *name == 'p' && name[1] == 'o' ? Form::point : Form::preintegrated,
                                             .stepVoxels = 0.5,
                                             .earlyTermination = true,
                                             .terminationOpacity = opacity});
      EXPECT_LT(meanDifference(ended.pictures[0], reference), 0.1 * kOneOf255);
    }
  }
}

TEST(DvrRaymarch, BothEyesEqualTwoSinglePictures) {
  const Scene scene = rippleScene();
  FrameInputs stereo = inputsFor(scene);
  View right = stereo.views[0];
  right.pose.position += 6.0 * right.pose.right;
  right.layer = 1;
  stereo.views.push_back(right);
  for (const char* name : {"post", "preintegrated"}) {
    const Drawn both = drawOnce(dvrRaymarch(), scene, stereo, kWidth, kHeight, kind(name, 1));
    for (std::size_t view = 0; view < 2; ++view) {
      FrameInputs mono = stereo;
      mono.views = {stereo.views[view]};
      mono.views[0].layer = 0;
      EXPECT_TRUE(identical(both.pictures[view], draw(scene, mono, kind(name, 1)))) << name << view;
    }
  }
}

TEST(DvrRaymarch, RepeatsAndCountsWithoutChangingThePicture) {
  for (const ShadingModel model : {ShadingModel::none, ShadingModel::lambert}) {
    const Scene scene = rippleScene(model);
    const FrameInputs inputs = inputsFor(scene, 0.5);
    for (const char* name : {"post", "preintegrated"}) {
      for (const bool jitter : {false, true}) {
        const Values values = {{"transfer_function_kind", std::string(name)},
                               {"preintegrated_size", std::int64_t(64)},
                               {"jitter", jitter}};
        Session session(dvrRaymarch(), scene, withParameters(dvrRaymarch(), values), {kWidth, kHeight, 1});
        const Picture first = session.draw(inputs).pictures[0];
        const Picture second = session.draw(inputs).pictures[0];
        session.reset();
        const Picture counted = session.draw(inputs, true).pictures[0];
        EXPECT_TRUE(identical(first, counted));
        EXPECT_EQ(identical(first, second), !jitter);
      }
    }
  }
}

TEST(DvrRaymarch, JitterKeepsThePictureOfShortSteps) {
  const Scene scene = rippleScene();
  const FrameInputs inputs = inputsFor(scene, 0.2);
  const Picture integral = referenceOf(scene, inputs, {.form = Form::converged, .tolerance = 1e-4});
  for (const char* name : {"post", "preintegrated"}) {
    Values values = kind(name, 0.1);
    values.emplace_back("jitter", true);
    EXPECT_LT(meanDifference(draw(scene, inputs, values), integral), 0.002) << name;
  }
  // The parts of slabs at both ends make pre-integration right at long steps, too.
  Values values = kind("preintegrated", 2);
  EXPECT_LT(meanDifference(draw(scene, inputs, values), integral), 0.01);
  values.emplace_back("jitter", true);
  EXPECT_LT(meanDifference(draw(scene, inputs, values), integral), 0.01);
}

TEST(DvrRaymarch, CountsSamplesAsTheGeometrySays) {
  const Scene scene = rippleScene(ShadingModel::lambert);
  const FrameInputs inputs = inputsFor(scene);
  std::uint64_t rays = 0;
  double steps = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto span = boxSpan(scene.volume->grid(), rayThroughPixel(inputs.views[0], x, y, kWidth, kHeight));
      if (!span) continue;
      ++rays;
      steps += std::ceil((span->exit - span->entry) / 0.7);
    }
  }
  const Drawn post = drawOnce(dvrRaymarch(), scene, inputs, kWidth, kHeight, kind("post", 0.7), true);
  EXPECT_EQ(post.counters.at("rays"), rays);
  EXPECT_NEAR(double(post.counters.at("samples")), steps, 5);
  EXPECT_LT(post.counters.at("gradients"), post.counters.at("samples"));
  EXPECT_GT(post.counters.at("gradients"), post.counters.at("samples") / 10);
  double counted = 0;
  for (const float count : post.pictures[0].steps)
    counted += count;
  EXPECT_EQ(counted, double(post.counters.at("samples")));
  // Slabs have one more sample a ray.
  const Drawn slabs = drawOnce(dvrRaymarch(), scene, inputs, kWidth, kHeight, kind("preintegrated", 0.7), true);
  EXPECT_NEAR(double(slabs.counters.at("samples")), steps + double(rays), 5);
}

TEST(DvrRaymarch, TakesNewTransferFunctions) {
  const Scene scene = rippleScene();
  FrameInputs inputs = inputsFor(scene, 0.1);
  for (const char* name : {"post", "preintegrated"}) {
    Session session(dvrRaymarch(), scene, withParameters(dvrRaymarch(), kind(name, 1)), {kWidth, kHeight, 1});
    const Picture thin = session.draw(inputs).pictures[0];
    FrameInputs dense = inputs;
    dense.transferFunction = ramp(0.8);
    EXPECT_TRUE(identical(session.draw(dense).pictures[0], draw(scene, dense, kind(name, 1))));
    EXPECT_TRUE(identical(session.draw(inputs).pictures[0], thin));
    dense.transferFunction = ramp(0);
    const Picture nothing = session.draw(dense).pictures[0];
    EXPECT_EQ(largestDifference(nothing, Picture(kWidth, kHeight)), 0);
  }
}

TEST(DvrRaymarch, VolumesWithoutThicknessAreTransparent) {
  const Scene scene = makeScene(makeVolume(ball, {40, 40, 1}, ScalarType::uint8), ShadingModel::none);
  const FrameInputs inputs = makeInputs(lookAtBox(scene.volume->grid(), 20, 15, kWidth, kHeight), 0.3, 1.0);
  for (const char* name : {"post", "preintegrated"})
    EXPECT_EQ(largestDifference(draw(scene, inputs, kind(name, 1)), Picture(kWidth, kHeight)), 0);
}

TEST(DvrRaymarch, SaysWhatMemoryItUses) {
  const Scene scene = rippleScene();
  const FrameInputs inputs = inputsFor(scene);
  const std::uint64_t before = device().ledger().totalBytes();
  for (const char* name : {"post", "preintegrated"}) {
    Session session(dvrRaymarch(), scene, withParameters(dvrRaymarch(), kind(name, 1)), {kWidth, kHeight, 1});
    const std::uint64_t prepared = device().ledger().totalBytes();
    session.draw(inputs);
    EXPECT_EQ(device().ledger().totalBytes(), prepared);
    std::uint64_t total = 0;
    for (const gpu::MemoryItem& item : session.technique().memory())
      total += item.bytes;
    EXPECT_EQ(total, session.preparedBytes());
  }
  EXPECT_EQ(device().ledger().totalBytes(), before);
}

} // namespace
} // namespace volmark::ray_march
