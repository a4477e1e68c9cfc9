// Timelines: poses, stereo, framing, sweeps and what changes between frames.
#include "timeline/timeline.h"
#include "volmark/error.h"

#include <gmock/gmock.h>

#include <cmath>

namespace volmark {
namespace {

using ::testing::HasSubstr;

std::shared_ptr<const Volume> volume(const Grid& grid, int timeSteps = 1, bool constant = false) {
  std::vector<std::byte> bytes(grid.voxelCount() * static_cast<std::size_t>(timeSteps));
  if (!constant) bytes.back() = std::byte{200};
  return std::make_shared<Volume>("test", grid, ScalarType::uint8, std::move(bytes), timeSteps);
}

class TimelineTest : public ::testing::Test {
protected:
  TimelineTest() {
    settings.scene.name = "test";
    settings.isovalue = Isovalue{false, 0.5};
    settings.transferFunction =
        std::make_shared<TransferFunction>("t", std::vector<ControlPoint>{{0, glm::dvec3(1), 0}});
  }
  Timeline timeline() const { return Timeline(settings, makeScene(settings, volume(grid, timeSteps))); }
  Pose poseAt(double phase) const { return timeline().at(phase).views.at(0).pose; }

  Grid grid{{30, 20, 10}, {1, 2, 3}};
  int timeSteps = 1;
  PointSettings settings;
};

void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-12) {
  EXPECT_LE(glm::length(a - b), tolerance * std::max(1.0, glm::length(b)))
      << a.x << " " << a.y << " " << a.z << " is not " << b.x << " " << b.y << " " << b.z;
}

void expectOrthonormal(const Pose& pose) {
  for (const glm::dvec3& axis : {pose.right, pose.up, pose.forward})
    EXPECT_NEAR(glm::length(axis), 1, 1e-14);
  expectNear(glm::cross(pose.right, pose.up), -pose.forward, 1e-14);
  EXPECT_NEAR(glm::dot(pose.right, pose.up), 0, 1e-14);
}

// --- Poses ---------------------------------------------------------------------------------------------------

TEST_F(TimelineTest, PosesAreOrthonormalAndLookAtTheCentre) {
  for (const double elevation : {-90.0, -30.0, 0.0, 20.0, 90.0})
    for (const Framing& framing : {Framing{}, Framing{{0, 0, 2}, {0, -1, 0}}, Framing{{1, 1, 0}, {0, 0, 3}}}) {
      settings.timeline.camera.elevationDegrees = elevation;
      settings.scene.framing = framing;
      const double distance = glm::length(poseAt(0).position);
      for (int i = 0; i <= 20; ++i) {
        const Pose pose = poseAt(i / 20.0);
        expectOrthonormal(pose);
        expectNear(glm::normalize(-pose.position), pose.forward);
        EXPECT_NEAR(glm::length(pose.position), distance, 1e-12 * distance);
        // The orbit keeps its height over the plane, and the camera isn't tilted.
        const glm::dvec3 up = glm::normalize(framing.up);
        EXPECT_NEAR(glm::dot(pose.position, up), distance * std::sin(glm::radians(elevation)), 1e-9);
        EXPECT_NEAR(glm::dot(pose.right, up), 0, 1e-14);
        EXPECT_GE(glm::dot(pose.up, up), -1e-14);
      }
    }
}

TEST_F(TimelineTest, MatchesLookAtAwayFromThePoles) {
  settings.scene.framing = {{0, 0, 1}, {0, -1, 0}};
  for (int i = 0; i < 7; ++i) {
    const Pose pose = poseAt(i / 7.0);
    const Pose expected = Pose::lookAt(pose.position, glm::dvec3(0), {0, 0, 1});
    expectNear(pose.right, expected.right);
    expectNear(pose.up, expected.up);
  }
}

/// y up, front +z: eye = D (sin a cos e, sin e, cos a cos e) with D = R / sin(fov/2).
TEST_F(TimelineTest, EightViewsOnACircleAreTheUsualOnes) {
  settings.camera.verticalFovDegrees = 30;
  settings.timeline.camera.elevationDegrees = 20;
  const glm::dvec3 extent(29, 38, 27);
  const double distance = 0.5 * glm::length(extent) / std::sin(glm::radians(15.0));
  const double e = glm::radians(20.0);
  for (int k = 0; k < 8; ++k) {
    const double a = 2 * M_PI * k / 8;
    const glm::dvec3 eye = distance * glm::dvec3(std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e));
    expectNear(poseAt(timeline().phaseOf(k, 8)).position, eye);
  }
}

TEST_F(TimelineTest, OrbitsCloseAndRevolve) {
  settings.timeline.camera.revolutions = 2;
  expectNear(poseAt(0.1).position, poseAt(0.6).position);
  settings.timeline.camera.revolutions = -1;
  const Pose backwards = poseAt(0.25);
  settings.timeline.camera.revolutions = 1;
  expectNear(backwards.position, poseAt(0.75).position);
  settings.timeline.camera.startAzimuthDegrees = 90;
  settings.timeline.camera.revolutions = 0;
  EXPECT_GT(poseAt(0).position.x, 1);
  EXPECT_EQ(poseAt(0).position, poseAt(0.9).position);
}

TEST_F(TimelineTest, FixedCamerasStay) {
  settings.timeline.camera.kind = CameraPath::Kind::fixed;
  settings.timeline.camera.startAzimuthDegrees = 45;
  EXPECT_EQ(poseAt(0).position, poseAt(0.7).position);
  EXPECT_NEAR(poseAt(0).position.x, poseAt(0).position.z, 1e-9);
}

// --- Framing -------------------------------------------------------------------------------------------------

TEST_F(TimelineTest, FitMakesTheBoundingSphereTouchTheSmallerField) {
  for (const auto& [width, height] : {std::pair(512, 512), std::pair(1920, 1080), std::pair(300, 700)})
    for (const double fov : {10.0, 30.0, 90.0}) {
      settings.width = width;
      settings.height = height;
      settings.camera.verticalFovDegrees = fov;
      const View view = timeline().at(0.3).views[0];
      const auto distanceToSide = [&](const glm::dvec3& along) {
        // The ray in the middle of a side of the frustum: its distance from the centre is the sphere's radius.
        const glm::dvec3 direction = glm::normalize(view.pose.forward + along);
        return glm::length(glm::cross(direction, -view.pose.position));
      };
      const double horizontal = distanceToSide(view.pose.right * view.frustum.right);
      const double vertical = distanceToSide(view.pose.up * view.frustum.up);
      EXPECT_NEAR(std::min(horizontal, vertical), grid.boundingRadiusMm(), 1e-9);
      EXPECT_NEAR(view.frustum.right / view.frustum.up, double(width) / height, 1e-12);
    }
}

TEST_F(TimelineTest, DistancesInMillimetresAreKept) {
  settings.camera.distanceMm = 123.25;
  EXPECT_NEAR(glm::length(poseAt(0.2).position), 123.25, 1e-12);
}

TEST_F(TimelineTest, OneVoxelCanBeLookedAt) {
  grid = Grid{{1, 1, 1}, {1, 1, 1}};
  settings.scene.visualisationRange = Range{0, 1};
  const Pose pose = poseAt(0);
  EXPECT_GT(glm::length(pose.position), 0);
  expectOrthonormal(pose);
}

// --- Stereo --------------------------------------------------------------------------------------------------

TEST_F(TimelineTest, EyesAreParallelAndTheBaselineApart) {
  const Pose centre = poseAt(0.37);
  settings.stereo.enabled = true;
  settings.stereo.interpupillaryDistanceMm = 63;
  const FrameInputs inputs = timeline().at(0.37);
  ASSERT_EQ(inputs.views.size(), 2u);
  const Pose& left = inputs.views[0].pose;
  const Pose& right = inputs.views[1].pose;
  expectNear(right.position - left.position, 63.0 * centre.right, 1e-11);
  expectNear(0.5 * (right.position + left.position), centre.position);
  EXPECT_EQ(left.forward, right.forward);
  EXPECT_EQ(left.up, right.up);
  EXPECT_EQ(inputs.views[0].layer, 0);
  EXPECT_EQ(inputs.views[1].layer, 1);
}

// --- Key poses -----------------------------------------------------------------------------------------------

class KeyTimelineTest : public TimelineTest {
protected:
  KeyTimelineTest() {
    settings.timeline.camera.kind = CameraPath::Kind::keys;
    settings.camera.distanceMm = 100;
    settings.timeline.camera.keys = {{0, 0, 1, false}, {90, 0, 2, false}, {180, 40, 1, true}, {0, 0, 1, false}};
  }
};

TEST_F(KeyTimelineTest, KeysAreReachedExactlyAndLinearlyBetween) {
  for (int i = 0; i < 4; ++i) {
    const CameraPath::Key& key = settings.timeline.camera.keys[i];
    EXPECT_NEAR(glm::length(poseAt(i / 3.0).position), 100 * key.distanceScale, 1e-9) << i;
    EXPECT_NEAR(poseAt(i / 3.0).position.y, 100 * key.distanceScale * std::sin(glm::radians(key.elevationDegrees)),
                1e-9);
  }
  const glm::dvec3 between = poseAt(1.0 / 6).position;
  expectNear(between, 150.0 * glm::dvec3(std::sin(M_PI / 4), 0, std::cos(M_PI / 4)), 1e-9);
}

TEST_F(KeyTimelineTest, CutsJumpAtTheirKeyAndAreReportedOnce) {
  const Timeline t = timeline();
  expectNear(poseAt(0.5).position, poseAt(1.0 / 3).position); // waits at key 1
  for (const int frames : {4, 7, 100, 301}) {
    int cuts = 0;
    for (int i = 1; i < frames; ++i) {
      const Changes changes = t.between(t.phaseOf(i - 1, frames), t.phaseOf(i, frames));
      cuts += changes.cut;
      if (changes.cut) {
        EXPECT_TRUE(changes.camera);
        EXPECT_LT(t.phaseOf(i - 1, frames), 2.0 / 3);
        EXPECT_GE(t.phaseOf(i, frames), 2.0 / 3 - 1e-9);
      }
    }
    EXPECT_EQ(cuts, 1) << frames;
  }
}

TEST_F(KeyTimelineTest, TheSeamIsACutUnlessThePathCloses) {
  settings.timeline.camera.keys = {{0, 0, 1, false}, {90, 0, 1, false}};
  EXPECT_TRUE(timeline().between(1, 0).cut);
  settings.timeline.camera.keys.push_back({0, 0, 1, false});
  EXPECT_FALSE(timeline().between(1, 0).cut);
}

TEST_F(KeyTimelineTest, TheEndIsShown) {
  EXPECT_EQ(timeline().phaseOf(0, 5), 0);
  EXPECT_EQ(timeline().phaseOf(4, 5), 1);
  EXPECT_EQ(timeline().phaseOf(0, 1), 0);
}

// --- What changes --------------------------------------------------------------------------------------------

TEST_F(TimelineTest, OrbitsEndOneStepBeforeTheirStart) {
  EXPECT_EQ(timeline().phaseOf(0, 8), 0);
  EXPECT_EQ(timeline().phaseOf(7, 8), 7.0 / 8);
  const Changes seam = timeline().between(7.0 / 8, 0);
  EXPECT_TRUE(seam.camera);
  EXPECT_FALSE(seam.cut);
  settings.timeline.camera.revolutions = 1.5;
  EXPECT_TRUE(timeline().between(7.0 / 8, 0).cut);
}

TEST_F(TimelineTest, OnlyWhatMovesIsReported) {
  const Changes still = timeline().between(0.25, 0.25);
  EXPECT_FALSE(still.camera || still.isovalue || still.timeStep || still.cut || still.light || still.transferFunction ||
               still.clippingPlanes);
  const Changes orbit = timeline().between(0.25, 0.5);
  EXPECT_TRUE(orbit.camera);
  EXPECT_FALSE(orbit.isovalue || orbit.timeStep || orbit.cut);
}

TEST_F(TimelineTest, TransferFunctionsBlendByASine) {
  settings.transferFunction = std::make_shared<TransferFunction>("a", std::vector<ControlPoint>{{0, {1, 0, 0}, 0.2}});
  const auto to = std::make_shared<TransferFunction>("b", std::vector<ControlPoint>{{0, {0, 1, 0}, 0.6}});
  EXPECT_EQ(timeline().at(0.1).transferFunction, settings.transferFunction);
  settings.timeline.blend = TransferFunctionBlend{.to = to, .cycles = 2};
  const auto opacityAt = [&](double phase) { return timeline().at(phase).transferFunction->evaluate(0.5).a; };
  EXPECT_NEAR(opacityAt(0), 0.4, 1e-12);
  EXPECT_NEAR(opacityAt(1.0 / 8), 0.6, 1e-12);
  EXPECT_NEAR(opacityAt(3.0 / 8), 0.2, 1e-12);
  EXPECT_NEAR(timeline().at(1.0 / 8).transferFunction->evaluate(0.5).g, 1, 1e-12);
  EXPECT_TRUE(timeline().between(0, 0.1).transferFunction);
  EXPECT_FALSE(timeline().between(0.1, 0.1).transferFunction);
}

TEST_F(TimelineTest, EqualPhasesGiveEqualInputs) {
  settings.timeline.isovalueSweep = {Isovalue{false, 0.1}, Isovalue{false, 0.9}};
  const FrameInputs a = timeline().at(0.123), b = timeline().at(0.123);
  EXPECT_EQ(a.views[0].pose.position, b.views[0].pose.position);
  EXPECT_EQ(a.isovalue, b.isovalue);
}

TEST_F(TimelineTest, SweepsRunFromEndToEnd) {
  settings.timeline.camera.kind = CameraPath::Kind::fixed;
  settings.timeline.isovalueSweep = {Isovalue{true, 50}, Isovalue{false, 0.75}}; // data 0 to 200
  const Timeline t = timeline();
  EXPECT_DOUBLE_EQ(t.at(t.phaseOf(0, 11)).isovalue, 0.25);
  EXPECT_DOUBLE_EQ(t.at(t.phaseOf(5, 11)).isovalue, 0.5);
  EXPECT_DOUBLE_EQ(t.at(t.phaseOf(10, 11)).isovalue, 0.75);
  const Changes changes = t.between(0, 0.1);
  EXPECT_TRUE(changes.isovalue);
  EXPECT_FALSE(changes.camera);
}

TEST_F(TimelineTest, AllTimeStepsPlayOnce) {
  timeSteps = 5;
  EXPECT_EQ(timeline().at(0.99).timeStep, 0);
  settings.timeline.playTimeSteps = true;
  const Timeline t = timeline();
  std::vector<int> shown;
  for (int i = 0; i < 20; ++i)
    shown.push_back(t.at(t.phaseOf(i, 20)).timeStep);
  for (int i = 0; i < 20; ++i)
    EXPECT_EQ(shown[i], i / 4);
  EXPECT_EQ(t.at(1).timeStep, 4);
  EXPECT_TRUE(t.between(0.19, 0.21).timeStep);
  EXPECT_FALSE(t.between(0.21, 0.22).timeStep);
}

TEST_F(TimelineTest, SettingsArePassedOn) {
  settings.timeline.clippingPlanes = {{{0, 1, 0}, 3}};
  settings.light.ambient = 0.4;
  const FrameInputs inputs = timeline().at(0);
  ASSERT_EQ(inputs.clippingPlanes.size(), 1u);
  EXPECT_EQ(inputs.clippingPlanes[0].offset, 3);
  EXPECT_EQ(inputs.light.ambient, 0.4);
  EXPECT_EQ(inputs.transferFunction, settings.transferFunction);
}

// --- Scene and isovalue --------------------------------------------------------------------------------------

template <class Action> std::string errorOf(Action&& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError";
  return "";
}

TEST_F(TimelineTest, TheRangeIsTheScenesElseTheDatas) {
  EXPECT_EQ(makeScene(settings, volume(grid)).visualisationRange.maximum, 200);
  settings.scene.visualisationRange = Range{-10, 30};
  const Scene scene = makeScene(settings, volume(grid));
  EXPECT_EQ(scene.visualisationRange.minimum, -10);
  EXPECT_DOUBLE_EQ(normalisedIsovalue({true, 0}, scene), 0.25);
  EXPECT_DOUBLE_EQ(normalisedIsovalue({false, 0.6}, scene), 0.6);
}

TEST_F(TimelineTest, IsovaluesOutsideOfTheRangeAreRefused) {
  const Scene scene = makeScene(settings, volume(grid));
  EXPECT_EQ(normalisedIsovalue({true, 0}, scene), 0);
  EXPECT_EQ(normalisedIsovalue({true, 200}, scene), 1);
  EXPECT_EQ(errorOf([&] {
              normalisedIsovalue({true, 201}, scene);
            }),
            "scene \"test\": isovalue: found raw 201, allowed: the visualisation range 0 to 200");
  EXPECT_THAT(errorOf([&] {
                normalisedIsovalue({false, -0.1}, scene);
              }),
              HasSubstr("found normalized -0.1, allowed: 0 to 1"));
  EXPECT_THAT(errorOf([&] { normalisedIsovalue({true, std::nan("")}, scene); }), HasSubstr("found raw nan"));
  settings.isovalue = Isovalue{true, 1000};
  EXPECT_THAT(errorOf([&] { timeline(); }), HasSubstr("found raw 1000"));
}

TEST_F(TimelineTest, ConstantVolumesNeedARange) {
  EXPECT_EQ(errorOf([&] { makeScene(settings, volume(grid, 1, true)); }),
            "scene \"test\": all voxels are 0, so that a \"visualisation_range\" [smallest, largest] has to be given");
  settings.scene.visualisationRange = Range{0, 1};
  EXPECT_NO_THROW(makeScene(settings, volume(grid, 1, true)));
}

} // namespace
} // namespace volmark
