// Five tiny techniques prove the interface: visible and lossless history, host threads, a streamed volume,
// asymmetric stereo.
#include "volmark/error.h"
#include "worker/replay.h"
#include "worker/test_session.h"
#include "worker/timed_pass.h"

#include <gmock/gmock.h>

namespace volmark::test {
namespace {

using testing::IsEmpty;

void nothing() {
}

std::uint64_t bytesOf(const std::vector<gpu::MemoryItem>& items) {
  std::uint64_t sum = 0;
  for (const auto& item : items)
    sum += item.bytes;
  return sum;
}

TEST(Modules, LoadWithoutProblems) {
  EXPECT_THAT(catalogue().problems(), IsEmpty());
  EXPECT_NE(catalogue().find("test_accumulate"), nullptr);
  EXPECT_NE(catalogue().find("box_depth"), nullptr);
}

TEST(VisibleHistory, FramesDependOnWhatCameBefore) {
  NEEDS_DEVICE();
  Session session(settingsFor("test_accumulate"), catalogue().get("test_accumulate"), rampVolume(), {"", true});
  session.prepare();
  session.reset();
  session.draw(0, 0, StampMode::headline);
  const auto first = session.pictures();
  session.draw(0, 1, StampMode::headline);
  const auto second = session.pictures();
  EXPECT_FALSE(equalBits(first, second));
  session.reset();
  session.draw(0, 0, StampMode::headline);
  EXPECT_TRUE(equalBits(session.pictures(), first));
  EXPECT_THAT(session.device()->validationMessages(), IsEmpty());
}

TEST(VisibleHistory, ReplayOfTheWholeTraceEqualsTheTimedFrame) {
  NEEDS_DEVICE();
  PointSettings settings = settingsFor("test_accumulate");
  settings.pacing.frames = 5;
  Session session(settings, catalogue().get("test_accumulate"), rampVolume(), {});
  session.prepare();
  TimedPass timed(session, nothing);
  timed.warmUp();
  timed.orbit(OrbitKind::headline, 0);
  timed.orbit(OrbitKind::headline, 1);
  const auto shown = session.pictures();
  const Trace trace = timed.trace();
  ASSERT_EQ(trace.phases.size(), 13u);
  EXPECT_EQ(trace.lastOrbitBegin, 8u);

  Replay replay(session, trace, nothing);
  const auto pictures = replay.draw({9, 12});
  EXPECT_TRUE(equalBits(pictures.at(12), shown));
  EXPECT_FALSE(equalBits(pictures.at(9), shown));
  EXPECT_TRUE(compareTimedWithReplay(shown, {pictures.at(12)}, true).passed);
  EXPECT_FALSE(compareTimedWithReplay(shown, {pictures.at(9)}, true).passed);
}

TEST(VisibleHistory, ConvergesToTheMeanOfItsNoise) {
  NEEDS_DEVICE();
  Session session(settingsFor("test_accumulate", 32, 32), catalogue().get("test_accumulate"), rampVolume(), {});
  session.prepare();
  session.reset();
  const int frames = 64;
  for (int i = 0; i < frames; ++i)
    session.draw(0, static_cast<std::uint64_t>(i), StampMode::headline);
  const Picture picture = session.pictures().front();
  double sum = 0;
  for (const glm::vec4& color : picture.color)
    sum += color.x;
  // The mean of n uniform samples has a standard deviation of 1 / sqrt(12 n).
  const double samples = double(frames) * picture.color.size();
  EXPECT_NEAR(sum / picture.color.size(), 0.5, 5 / std::sqrt(12 * samples) + 1e-3);
}

TEST(LosslessHistory, DoesNotShow) {
  NEEDS_DEVICE();
  PointSettings settings = settingsFor("test_lossless");
  settings.pacing.frames = 6;
  Session session(settings, catalogue().get("test_lossless"), rampVolume(), {"", true});
  session.prepare();
  TimedPass timed(session, nothing);
  timed.warmUp();
  timed.orbit(OrbitKind::headline, 0);
  const Trace trace = timed.trace();
  Replay replay(session, trace, nothing);
  const auto pictures = replay.draw({trace.phases.size() - 1});
  EXPECT_TRUE(compareWithFreshState(session, trace, trace.phases.size() - 1, pictures.begin()->second).passed);
  EXPECT_FALSE(compareWithFreshState(session, trace, trace.phases.size() - 2, pictures.begin()->second).passed);
  EXPECT_THAT(session.device()->validationMessages(), IsEmpty());
}

TEST(LosslessHistory, CountsOnlyTheWorkItDid) {
  NEEDS_DEVICE();
  PointSettings settings = settingsFor("test_lossless");
  settings.timeline.camera.kind = CameraPath::Kind::fixed;
  settings.pacing.frames = 4;
  Session session(settings, catalogue().get("test_lossless"), rampVolume(), {});
  session.prepare();
  session.reset();
  for (int i = 0; i < 3; ++i) {
    session.draw(0.25 * i, static_cast<std::uint64_t>(i), StampMode::headline, true);
    EXPECT_EQ(session.technique().counters().front().value, i == 0 ? 24u * 16u : 0u) << i;
  }
}

TEST(HostThreads, AnyNumberGivesTheSamePicture) {
  std::vector<std::vector<Picture>> pictures;
  for (const int threads : {1, 2, 5}) {
    PointSettings settings = settingsFor("test_host_threads");
    settings.parameters.set("threads", std::int64_t(threads));
    Session session(settings, catalogue().get("test_host_threads"), rampVolume(), {});
    EXPECT_EQ(session.device(), nullptr);
    session.prepare();
    session.reset();
    const CompletedFrame frame = session.draw(0.1, 0, StampMode::breakdown);
    EXPECT_GT(frame.times.drawMs(), 0);
    EXPECT_TRUE(std::isnan(frame.times.gpuMs));
    ASSERT_EQ(frame.times.passes.size(), 1u);
    EXPECT_EQ(frame.times.passes.front().name, "project");
    pictures.push_back(session.pictures());
  }
  EXPECT_TRUE(equalBits(pictures[0], pictures[1]));
  EXPECT_TRUE(equalBits(pictures[0], pictures[2]));
}

TEST(Streamed, EachTimeStepIsTheOneOnTheTimeline) {
  NEEDS_DEVICE();
  PointSettings settings = settingsFor("test_streamed", 8, 8);
  settings.timeline.playTimeSteps = true;
  const auto volume = rampVolume(8, 5);
  Session session(settings, catalogue().get("test_streamed"), volume, {"", true});
  session.prepare();
  session.reset();
  std::uint64_t index = 0;
  for (const double phase : {0.0, 0.3, 0.3, 0.95, 0.1}) {
    session.draw(phase, index++, StampMode::headline);
    const int step = session.timeline().at(phase).timeStep;
    const Picture picture = session.pictures().front();
    for (int x = 0; x < 8; ++x)
      EXPECT_NEAR(picture.color[picture.index(x, 3)].x, session.scene().normalised(volume->value(x, 3, 4, step)), 1e-3);
  }
  EXPECT_THAT(session.device()->validationMessages(), IsEmpty());
}

TEST(AsymmetricStereo, RaysAreThoseOfTheViews) {
  NEEDS_DEVICE();
  PointSettings settings = settingsFor("test_asymmetric_stereo");
  settings.stereo.enabled = true;
  Session session(settings, catalogue().get("test_asymmetric_stereo"), rampVolume(), {"", true});
  session.prepare();
  session.reset();
  session.draw(0.2, 0, StampMode::headline);
  const auto pictures = session.pictures();
  ASSERT_EQ(pictures.size(), 2u);
  const FrameInputs inputs = session.timeline().at(0.2);
  for (std::size_t view = 0; view < 2; ++view) {
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 24; ++x) {
        const glm::dvec3 expected = 0.5 + 0.5 * rayThroughPixel(inputs.views[view], x, y, 24, 16).direction;
        const glm::vec4 found = pictures[view].color[pictures[view].index(x, y)];
        ASSERT_LT(glm::length(glm::dvec3(found) - expected), 2e-3) << view << " " << x << " " << y;
      }
    }
  }
  EXPECT_GT(glm::length(inputs.views[0].pose.position - inputs.views[1].pose.position), 1);
}

class EveryGpuTechnique : public testing::TestWithParam<const char*> {};

TEST_P(EveryGpuTechnique, SaysTheMemoryThatItUses) {
  NEEDS_DEVICE();
  Session session(settingsFor(GetParam()), catalogue().get(GetParam()), rampVolume(), {});
  session.prepare();
  session.reset();
  for (std::uint64_t i = 0; i < 3; ++i)
    session.draw(0.1 * i, i, StampMode::headline);
  EXPECT_EQ(bytesOf(session.technique().memory()), session.techniqueBytes());
}

TEST_P(EveryGpuTechnique, DrawsTheSameWithTwoFramesInFlight) {
  NEEDS_DEVICE();
  std::vector<std::vector<Picture>> pictures;
  for (const int frames : {1, 2}) {
    PointSettings settings = settingsFor(GetParam());
    settings.measure.framesInFlight = frames;
    settings.pacing.frames = 7;
    Session session(settings, catalogue().get(GetParam()), rampVolume(), {});
    session.prepare();
    TimedPass timed(session, nothing);
    timed.warmUp();
    timed.orbit(OrbitKind::headline, 0);
    EXPECT_EQ(timed.rows().size(), 10u);
    pictures.push_back(session.pictures());
  }
  EXPECT_TRUE(equalBits(pictures[0], pictures[1]));
}

TEST_P(EveryGpuTechnique, BreakdownPassesAreTheDeclaredOnes) {
  NEEDS_DEVICE();
  Session session(settingsFor(GetParam()), catalogue().get(GetParam()), rampVolume(), {});
  const FrameTimes generation = session.prepare();
  for (const auto& pass : generation.passes)
    EXPECT_TRUE(std::any_of(session.info().generation.begin(), session.info().generation.end(),
                            [&](const PassDescriptor& known) { return known.name == pass.name; }))
        << pass.name;
  session.reset();
  const CompletedFrame frame = session.draw(0, 0, StampMode::breakdown);
  ASSERT_FALSE(frame.times.passes.empty());
  for (const auto& pass : frame.times.passes)
    EXPECT_TRUE(std::any_of(session.info().passes.begin(), session.info().passes.end(),
                            [&](const PassDescriptor& known) { return known.name == pass.name; }))
        << pass.name;
}

INSTANTIATE_TEST_SUITE_P(All, EveryGpuTechnique,
                         testing::Values("test_accumulate", "test_lossless", "test_streamed", "test_asymmetric_stereo",
                                         "box_depth"));

TEST(Unsupported, SaysWhyInOneSentence) {
  PointSettings settings = settingsFor("test_faults");
  settings.parameters.set("fault", std::string("unsupported"));
  Session session(settings, catalogue().get("test_faults"), rampVolume(), {});
  EXPECT_THROW(session.prepare(), UnsupportedError);
}

} // namespace
} // namespace volmark::test
