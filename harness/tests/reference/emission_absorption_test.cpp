#include "fixture.h"

#include <gtest/gtest.h>

#include <random>

namespace volmark::reference {

namespace {

using Form = VolumeSamples::Form;

/// n voxels of `spacing` along z, between z = 0.5*(n-1)*spacing (nearest the camera at +z) and its negative.
Grid column(int n, double spacing = 1) {
  return {{2, 2, n}, glm::dvec3(spacing)};
}

/// 0 where the ray enters, 1 where it leaves.
FieldFunction rampAlong(const Grid& grid) {
  const double half = grid.boxMaximum().z;
  return [half](const glm::dvec3& p) { return 0.5 - 0.5 * p.z / half; };
}

FrameInputs inputsWith(std::shared_ptr<const TransferFunction> function) {
  FrameInputs inputs = inputsOf(viewFrom({0, 0, 100}));
  inputs.transferFunction = std::move(function);
  return inputs;
}

std::shared_ptr<const TransferFunction> functionOf(std::vector<ControlPoint> points) {
  return std::make_shared<TransferFunction>("test", std::move(points));
}

VolumeSamples samplesOf(Form form, double step = 1) {
  VolumeSamples samples;
  samples.form = form;
  samples.stepVoxels = step;
  return samples;
}

constexpr std::array kForms = {Form::point, Form::preintegrated, Form::converged};

float largest(const glm::vec4& v) {
  return std::max({std::abs(v.r), std::abs(v.g), std::abs(v.b), std::abs(v.a)});
}

/// Smooth noise of a few waves, in [0,1].
double waves(const glm::dvec3& p) {
  return 0.5 + 0.5 * std::sin(2.1 * p.x + std::sin(1.3 * p.y)) * std::cos(1.7 * p.z + p.y);
}

std::shared_ptr<const TransferFunction> kinky() {
  return functionOf({{0.3, {1, 0, 0}, 0},
                     {0.35, {1, 1, 0}, 0.6},
                     {0.4, {0, 1, 0}, 0},
                     {0.7, {0, 0, 1}, 0},
                     {0.75, {0, 1, 1}, 0.3},
                     {0.75, {1, 1, 1}, 0.05}});
}

} // namespace

TEST(Volume, HomogeneousMediumHasAClosedForm) {
  const Scene scene = sceneOf(column(9), [](const glm::dvec3&) { return 0.5; });
  const FrameInputs inputs = inputsWith(opacities({{0, 0.2}, {1, 0.2}}, {1, 0.5, 0.25}));
  const double opacity = 1 - std::pow(0.8, 8);
  for (const Form form : kForms)
    for (const double step : {1.0, 0.5, 2.0}) {
      const glm::vec4 seen = volumeInTheMiddle(scene, inputs, samplesOf(form, step));
      EXPECT_LT(largest(seen - glm::vec4(glm::dvec4(1, 0.5, 0.25, 1) * opacity)), 1e-6f);
    }
}

TEST(Volume, OneVoxelLengthIsTheSmallestSpacing) {
  // 4 voxels of 3 units along z, 2 along x: 9 units are 4.5 voxel lengths.
  const Scene scene = sceneOf({{4, 4, 4}, {2, 2.5, 3}}, [](const glm::dvec3&) { return 0.5; });
  const FrameInputs inputs = inputsWith(opacities({{0, 0.3}, {1, 0.3}}));
  for (const Form form : kForms)
    EXPECT_NEAR(volumeInTheMiddle(scene, inputs, samplesOf(form, 0.5)).a, 1 - std::pow(0.7, 4.5), 1e-6);
}

TEST(Volume, LastStepEndsAtTheExitForSlabsOnly) {
  // 4 voxel lengths in steps of 1.5: samples at 0, 1.5 and 3.
  const Scene scene = sceneOf(column(5), [](const glm::dvec3&) { return 0.5; });
  const FrameInputs inputs = inputsWith(opacities({{0, 0.2}, {1, 0.2}}));
  EXPECT_NEAR(volumeInTheMiddle(scene, inputs, samplesOf(Form::point, 1.5)).a, 1 - std::pow(0.8, 4.5), 1e-6);
  EXPECT_NEAR(volumeInTheMiddle(scene, inputs, samplesOf(Form::preintegrated, 1.5)).a, 1 - std::pow(0.8, 4), 1e-6);
}

TEST(Volume, ClippingPlanesMoveNoSample) {
  // 4 voxel lengths from z = 2 to -2; the plane keeps z <= 1.3: samples at 1, 0 and -1, slabs from 1.3 on.
  const Scene scene = sceneOf(column(5), [](const glm::dvec3&) { return 0.5; });
  FrameInputs inputs = inputsWith(opacities({{0, 0.2}, {1, 0.2}}));
  inputs.clippingPlanes = {{-glm::normalize(inputs.views[0].pose.position), -1.3}};
  EXPECT_NEAR(volumeInTheMiddle(scene, inputs, samplesOf(Form::point)).a, 1 - std::pow(0.8, 3), 1e-6);
  EXPECT_NEAR(volumeInTheMiddle(scene, inputs, samplesOf(Form::preintegrated)).a, 1 - std::pow(0.8, 3.3), 1e-6);
}

TEST(Volume, PointSamplesByHand) {
  // Values 0, 1/4, 1/2, 3/4 (and 1 at the exit, which is no sample), opacity equal to the value.
  const Scene scene = sceneOf(column(5), rampAlong(column(5)));
  const FrameInputs inputs = inputsWith(functionOf({{0, {1, 0, 0}, 0}, {1, {0, 1, 0}, 1}}));
  const glm::vec4 seen = volumeInTheMiddle(scene, inputs, samplesOf(Form::point));
  const double red = 0.25 * 0.75 + 0.75 * 0.5 * 0.5 + 0.75 * 0.5 * 0.75 * 0.25;
  const double green = 0.25 * 0.25 + 0.75 * 0.5 * 0.5 + 0.75 * 0.5 * 0.75 * 0.75;
  EXPECT_LT(largest(seen - glm::vec4(red, green, 0, 1 - 0.75 * 0.5 * 0.25)), 1e-6f);
}

TEST(Volume, TwoLayers) {
  // Red for 3 of 8 voxels, blue behind: a jump that slabs and the integral see exactly.
  const Scene scene = sceneOf(column(9), rampAlong(column(9)));
  const FrameInputs inputs = inputsWith(
      functionOf({{0, {1, 0, 0}, 0.1}, {0.375, {1, 0, 0}, 0.1}, {0.375, {0, 0, 1}, 0.4}, {1, {0, 0, 1}, 0.4}}));
  const double red = 1 - std::pow(0.9, 3);
  const double blue = (1 - red) * (1 - std::pow(0.6, 5));
  for (const auto& samples : {samplesOf(Form::converged), samplesOf(Form::preintegrated, 2)})
    EXPECT_LT(largest(volumeInTheMiddle(scene, inputs, samples) - glm::vec4(red, 0, blue, red + blue)), 1e-5f);
}

TEST(Volume, RampOfColourHasAClosedForm) {
  // Constant extinction e, colour s/L: the integral of s/L e exp(-e s) ds.
  const Scene scene = sceneOf(column(11), rampAlong(column(11)));
  const FrameInputs inputs = inputsWith(functionOf({{0, {0, 1, 0}, 0.15}, {1, {1, 1, 0}, 0.15}}));
  const double depth = -10 * std::log(0.85);
  const double red = (1 - std::exp(-depth) * (1 + depth)) / depth;
  const double alpha = 1 - std::exp(-depth);
  for (const auto& samples : {samplesOf(Form::converged), samplesOf(Form::preintegrated, 2.5)})
    EXPECT_LT(largest(volumeInTheMiddle(scene, inputs, samples) - glm::vec4(red, alpha, 0, alpha)), 1e-5f);
}

TEST(Volume, RampOfOpacityHasAClosedForm) {
  // Opacity A s/L: the optical depth is L (A + (1-A) ln(1-A)) / A.
  const Scene scene = sceneOf(column(11), rampAlong(column(11)));
  for (const double top : {0.1, 0.6}) {
    const FrameInputs inputs = inputsWith(opacities({{0, 0}, {1, top}}));
    const double depth = 10 * (top + (1 - top) * std::log(1 - top)) / top;
    EXPECT_NEAR(volumeInTheMiddle(scene, inputs, samplesOf(Form::converged)).a, 1 - std::exp(-depth), 1e-5);
  }
}

TEST(Volume, OpacityIsCapped) {
  const Scene scene = sceneOf(column(2), [](const glm::dvec3&) { return 1; });
  for (const Form form : kForms) {
    const float alpha = volumeInTheMiddle(scene, inputsWith(opacities({{0, 1}, {1, 1}})), samplesOf(form)).a;
    EXPECT_NEAR(alpha, 0.9999, 1e-6);
  }
}

TEST(Volume, CubicAlongADiagonal) {
  // The field is s^3 along the diagonal of one cell. Compared with the integral over 10^5 midpoints.
  const Grid cell{{2, 2, 2}, glm::dvec3(1)};
  const Scene scene = sceneOf(cell, [](const glm::dvec3& p) { return p.x > 0 && p.y > 0 && p.z > 0 ? 1 : 0; });
  FrameInputs inputs = inputsWith(kinky());
  inputs.views = {viewFrom(glm::dvec3(-3))};
  double depth = 0;
  glm::dvec3 color(0);
  for (int i = 0; i < 100000; ++i) {
    const glm::dvec4 at = inputs.transferFunction->evaluate(std::pow((i + 0.5) / 100000, 3));
    const double part = -std::log(1 - at.a) * std::sqrt(3.0) / 100000;
    color += glm::dvec3(at) * std::exp(-depth - 0.5 * part) * part;
    depth += part;
  }
  const glm::vec4 seen = volumeInTheMiddle(scene, inputs, samplesOf(Form::converged));
  EXPECT_LT(largest(seen - glm::vec4(glm::dvec4(color, 1 - std::exp(-depth)))), 1e-4f);
}

TEST(Volume, ToleranceIsKept) {
  const Scene scene = sceneOf({{12, 12, 12}, glm::dvec3(0.6)}, waves);
  FrameInputs inputs = inputsWith(kinky());
  inputs.views = {viewFrom({5, 4, 9}, {0, 1, 0}, 0.3)};
  VolumeSamples samples = samplesOf(Form::converged);
  samples.tolerance = 1e-7;
  const Picture fine = renderVolume(scene, inputs, 0, 16, 16, samples);
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    samples.tolerance = tolerance;
    const Picture picture = renderVolume(scene, inputs, 0, 16, 16, samples);
    for (std::size_t i = 0; i < fine.color.size(); ++i)
      EXPECT_LT(largest(picture.color[i] - fine.color[i]), tolerance + 1e-6);
  }
}

namespace {

/// Mean largest error of a form against the integral.
double meanError(const Scene& scene, const FrameInputs& inputs, const Picture& truth, const VolumeSamples& samples) {
  const Picture picture = renderVolume(scene, inputs, 0, truth.width, truth.height, samples);
  double sum = 0;
  for (std::size_t i = 0; i < truth.color.size(); ++i)
    sum += largest(picture.color[i] - truth.color[i]);
  return sum / static_cast<double>(truth.color.size());
}

} // namespace

TEST(Volume, FormsConvergeToTheIntegralAndSlabsFaster) {
  for (const ShadingModel model : {ShadingModel::none, ShadingModel::phong}) {
    Scene scene = sceneOf({{12, 12, 12}, glm::dvec3(0.6)}, waves);
    scene.shading.model = model;
    FrameInputs inputs = inputsWith(kinky());
    inputs.views = {viewFrom({5, 4, 9}, {0, 1, 0}, 0.3)};
    inputs.light = {
        .headlight = false, .direction = glm::normalize(glm::dvec3(1, 2, 3)), .color = glm::dvec3(1), .ambient = 0.1};
    VolumeSamples exact = samplesOf(Form::converged);
    exact.tolerance = 1e-5;
    const Picture truth = renderVolume(scene, inputs, 0, 20, 20, exact);
    double points = 1;
    double slabs = 1;
    for (const double step : {0.5, 0.125, 0.03125}) {
      const double pointError = meanError(scene, inputs, truth, samplesOf(Form::point, step));
      const double slabError = meanError(scene, inputs, truth, samplesOf(Form::preintegrated, step));
      EXPECT_LT(pointError, points / 2.5) << step;
      EXPECT_LT(slabError, slabs / 2.5) << step;
      EXPECT_LT(slabError, pointError / (model == ShadingModel::none ? 4 : 1)) << step;
      points = pointError;
      slabs = slabError;
    }
    EXPECT_LT(points, 0.01);
  }
}

TEST(Volume, OpacityStaysInRangeAndGrowsWithTheVolumeKept) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0, 1);
  const Scene scene = sceneOf({{9, 9, 9}, glm::dvec3(1)}, [&](const glm::dvec3&) { return uniform(random); });
  FrameInputs inputs = inputsWith(kinky());
  inputs.views = {viewFrom({5, 7, 12}, {0, 1, 0}, 0.2)};
  Picture before(12, 12);
  // Uncover the volume from the front to the back.
  for (const double depth : {-10, -8, -4, 0, 3, 6, 20}) {
    inputs.clippingPlanes = {{inputs.views[0].pose.position, 0}};
    const double far = glm::length(inputs.views[0].pose.position);
    inputs.clippingPlanes[0].offset = -depth * far;
    const Picture picture = renderVolume(scene, inputs, 0, 12, 12, samplesOf(Form::converged));
    for (std::size_t i = 0; i < picture.color.size(); ++i) {
      const glm::vec4& now = picture.color[i];
      EXPECT_GE(now.a, before.color[i].a - 1e-4f);
      EXPECT_LE(now.a, 1);
      for (int c = 0; c < 3; ++c) {
        EXPECT_GE(now[c], before.color[i][c] - 1e-4f);
        EXPECT_LE(now[c], now.a + 1e-6f);
      }
      EXPECT_EQ(picture.distance[i], HUGE_VALF);
    }
    before = picture;
  }
}

TEST(Volume, EarlyTerminationKeepsItsPromise) {
  const Scene scene = sceneOf(column(41), waves);
  const FrameInputs inputs = inputsWith(opacities({{0, 0.1}, {1, 0.4}}));
  for (const Form form : {Form::point, Form::preintegrated}) {
    VolumeSamples samples = samplesOf(form);
    const glm::vec4 whole = volumeInTheMiddle(scene, inputs, samples);
    samples.earlyTermination = true;
    samples.terminationOpacity = 0.9;
    const glm::vec4 stopped = volumeInTheMiddle(scene, inputs, samples);
    EXPECT_GE(stopped.a, 0.9f);
    EXPECT_LT(stopped.a, 0.95f);
    EXPECT_LE(largest(whole - stopped), 0.1f);
  }
}

TEST(Volume, ShadingByHand) {
  // A ramp along the ray: the gradient faces the eye everywhere, so phong adds 0.3 of the alpha and lambert nothing.
  Scene scene = sceneOf(column(9), rampAlong(column(9)));
  const FrameInputs inputs = inputsWith(opacities({{0, 0.1}, {1, 0.3}}, {0.5, 0.25, 1}));
  for (const Form form : kForms) {
    scene.shading.model = ShadingModel::none;
    const glm::vec4 plain = volumeInTheMiddle(scene, inputs, samplesOf(form));
    EXPECT_NEAR(plain.r, 0.5 * plain.a, 1e-6);
    scene.shading.model = ShadingModel::lambert;
    EXPECT_LT(largest(volumeInTheMiddle(scene, inputs, samplesOf(form)) - plain), 1e-6f);
    scene.shading.model = ShadingModel::phong;
    const glm::vec4 expected = plain + glm::vec4(glm::vec3(0.3f * plain.a), 0);
    EXPECT_LT(largest(volumeInTheMiddle(scene, inputs, samplesOf(form)) - expected), 1e-6f);
  }
}

TEST(Volume, LightFromTheEyesSideIsAbsorbedTwice) {
  // What a depth sends back is weakened on both ways: the integral of c T^2 dtau, T = exp(-tau), is c (1 - T^2)/2.
  Scene scene = sceneOf(column(9), rampAlong(column(9)));
  scene.shading = {.model = ShadingModel::lambert, .shadows = true};
  FrameInputs inputs = inputsWith(opacities({{0, 0.3}, {1, 0.3}}, {0.5, 0.25, 1}));
  inputs.light = {.headlight = false, .direction = {0, 0, 1}, .spot = true, .distance = 4, .ambient = 0};
  const double transmittance = std::pow(0.7, 8);
  const glm::vec4 seen = volumeInTheMiddle(scene, inputs, samplesOf(Form::converged));
  EXPECT_NEAR(seen.r, 0.5 * 0.5 * (1 - transmittance * transmittance), 1e-4);
  EXPECT_NEAR(seen.a, 1 - transmittance, 1e-5);
  // From behind, the light passes through all of the rest: c T_all at every depth, and Lambert's surfaces face away.
  inputs.light.direction = {0, 0, -1};
  EXPECT_NEAR(volumeInTheMiddle(scene, inputs, samplesOf(Form::converged)).r, 0, 1e-6);
  // A plane that keeps the far half makes the way of the light shorter, too.
  inputs.light.direction = {0, 0, 1};
  inputs.clippingPlanes = {{{0, 0, -1}, 0}};
  const double half = std::pow(0.7, 4);
  EXPECT_NEAR(volumeInTheMiddle(scene, inputs, samplesOf(Form::converged)).r, 0.5 * 0.5 * (1 - half * half), 1e-4);
}

TEST(Volume, BeyondClippingPlanesTheOtherFunctionHolds) {
  Scene scene = sceneOf(column(9), rampAlong(column(9)));
  scene.functionBeyond = opacities({{0, 0.05}, {1, 0.05}}, {1, 0, 0});
  FrameInputs inputs = inputsWith(opacities({{0, 0.3}, {1, 0.3}}, {0, 0, 1}));
  inputs.clippingPlanes = {{{0, 0, 1}, -2}, {{0, 0, -1}, -2}}; // keep the middle half
  const double thin = std::pow(0.95, 2);
  const double thick = std::pow(0.7, 4);
  const glm::vec4 seen = volumeInTheMiddle(scene, inputs, samplesOf(Form::converged));
  EXPECT_NEAR(seen.a, 1 - thin * thick * thin, 1e-5);
  EXPECT_NEAR(seen.r, (1 - thin) + thin * thick * (1 - thin), 1e-5);
  EXPECT_NEAR(seen.b, thin * (1 - thick), 1e-5);
  // Planes that keep nothing leave all of it to the other function.
  inputs.clippingPlanes = {{{0, 0, 1}, 100}};
  EXPECT_NEAR(volumeInTheMiddle(scene, inputs, samplesOf(Form::converged)).a, 1 - std::pow(0.95, 8), 1e-5);
}

TEST(Volume, HiddenSegmentsAreLeftOut) {
  // Nine voxels along the ray, labels 0 to 8: hidden ones take away what is nearest to them, half a cell each way.
  const Grid grid = column(9);
  Scene scene = sceneOf(grid, rampAlong(grid));
  std::vector<std::byte> labels;
  for (int z = 0; z < grid.dims.z; ++z)
    for (int i = 0; i < grid.dims.x * grid.dims.y; ++i)
      labels.push_back(static_cast<std::byte>(z));
  scene.volume = std::make_shared<const Volume>(
      scene.volume->withLabels(std::make_shared<const Volume>("labels", grid, ScalarType::uint8, std::move(labels))));
  FrameInputs inputs = inputsWith(opacities({{0, 0.3}, {1, 0.3}}));
  inputs.hiddenSegments.set(2).set(3).set(8);
  // Two cells and the half one at the end.
  EXPECT_NEAR(volumeInTheMiddle(scene, inputs, samplesOf(Form::converged)).a, 1 - std::pow(0.7, 8 - 2.5), 1e-5);
  inputs.hiddenSegments.set();
  for (const Form form : kForms)
    EXPECT_EQ(volumeInTheMiddle(scene, inputs, samplesOf(form)), glm::vec4(0));
}

TEST(Volume, SamplesWithoutGradientKeepTheirColour) {
  // A ramp of one per voxel, clamped to 1 from voxel 1 on: samples 0 and 1 have a gradient, 2 and 3 have none.
  const Grid grid{{2, 2, 5}, glm::dvec3(2)};
  Scene scene = sceneOf(grid, [&](const glm::dvec3& p) { return grid.toVoxel(p).z; });
  scene.shading.model = ShadingModel::gooch;
  FrameInputs inputs = inputsWith(opacities({{0, 0.5}, {1, 0.5}}, glm::dvec3(0)));
  inputs.views = {viewFrom({0, 0, -100})};
  inputs.light = {.headlight = false, .direction = {0, 0, 1}, .color = glm::dvec3(1), .ambient = 0};
  // Lit from behind, black turns cool (blue 0.4) where there is a gradient.
  // The same for slabs, which are lit at their fronts, and for the integral, where the gradient ends at voxel 2.
  for (const Form form : kForms) {
    const glm::vec4 seen = volumeInTheMiddle(scene, inputs, samplesOf(form));
    EXPECT_NEAR(seen.b, 0.4 * 0.75, 1e-6);
    EXPECT_NEAR(seen.r, 0, 1e-6);
  }
}

TEST(Volume, WithoutGradientNothingIsShaded) {
  Scene scene = sceneOf(column(9), [](const glm::dvec3&) { return 0.5; });
  const FrameInputs inputs = inputsWith(opacities({{0, 0.1}, {1, 0.3}}));
  const glm::vec4 plain = volumeInTheMiddle(scene, inputs, samplesOf(Form::converged));
  scene.shading.model = ShadingModel::gooch;
  EXPECT_EQ(volumeInTheMiddle(scene, inputs, samplesOf(Form::converged)), plain);
}

TEST(Volume, PathsOfNoLengthGatherNothing) {
  const Scene scene = sceneOf({{4, 4, 1}, glm::dvec3(1)}, [](const glm::dvec3&) { return 1; });
  for (const Form form : kForms)
    EXPECT_EQ(volumeInTheMiddle(scene, inputsOf(viewFrom({0, 0, 10})), samplesOf(form)), glm::vec4(0));
  // Along the plane the ray has a length.
  EXPECT_NEAR(volumeInTheMiddle(scene, inputsOf(viewFrom({-10, 0, 0})), samplesOf(Form::point)).a, 0.875, 1e-6);
}

TEST(Volume, QuarterTurnsOfASymmetricVolumeLookTheSame) {
  Scene scene = sceneOf({glm::ivec3(9), glm::dvec3(0.5)},
                        [](const glm::dvec3& p) { return 0.5 + 0.5 * std::cos(p.x) * std::cos(p.y) * std::cos(p.z); });
  scene.shading.model = ShadingModel::phong;
  FrameInputs inputs = inputsWith(kinky());
  for (const Form form : kForms) {
    inputs.views = {viewFrom({0, 0, 7}), viewFrom({7, 0, 0}), viewFrom({0, -7, 0}, {0, 0, 1}),
                    viewFrom({0, 0, 7}, {1, 0, 0})};
    const Picture front = renderVolume(scene, inputs, 0, 9, 9, samplesOf(form, 0.5));
    for (int view = 1; view < 4; ++view) {
      const Picture turned = renderVolume(scene, inputs, view, 9, 9, samplesOf(form, 0.5));
      for (std::size_t i = 0; i < front.color.size(); ++i)
        EXPECT_LT(largest(turned.color[i] - front.color[i]), 2e-4f);
    }
  }
}

} // namespace volmark::reference
