#include "gpu_test.h"
#include "volmark/gpu/frame_recorder.h"
#include "volmark/gpu/stamp_self_test.h"
#include "volmark/host_recorder.h"

#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>

namespace volmark::gpu::test {

namespace {

void sleepMs(int ms) {
  std::this_thread::sleep_for(std::chrono::milliseconds(ms));
}

class RecorderTest : public GpuTest {
protected:
  void SetUp() override {
    GpuTest::SetUp();
    if (!sharedDevice()) return;
    m_pipeline = Pipeline(
        device(),
        ComputePipelineDescription{"work", {"volmark/stamp_work.comp.glsl"}, {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER}, 4}});
    m_results = Buffer(device(), {"results", 64 * 64 * 4, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT});
  }
  void TearDown() override {
    m_pipeline = {};
    m_results = {};
    GpuTest::TearDown();
  }

  void work(Recorder& recorder, const char* name, std::uint32_t rounds = 2000) {
    const Pass pass = recorder.pass(name);
    record(recorder.gpu(), rounds);
  }
  void record(Commands& commands, std::uint32_t rounds) {
    const Resource resources[] = {m_results.range()};
    commands.dispatch(m_pipeline, resources, bytesOf(rounds), {64, 1, 1});
    commands.barrier(kComputeWrite, kComputeWrite);
  }

  Pipeline m_pipeline;
  Buffer m_results;
};

std::vector<std::string> namesOf(const FrameTimes& times) {
  std::vector<std::string> names;
  for (const auto& pass : times.passes)
    names.push_back(pass.name);
  return names;
}

} // namespace

TEST_F(RecorderTest, HeadlineFramesHaveTotalsAndHostPassesOnly) {
  Commands commands(device());
  FrameRecorder recorder(commands, StampMode::headline);
  for (int frame = 0; frame < 2; ++frame) { // the second one reuses slot and queries
    recorder.beginFrame();
    work(recorder, "a");
    recorder.markUpdateDone();
    work(recorder, "b");
    {
      const Pass pass = recorder.hostPass("sort");
      sleepMs(3);
    }
    recorder.endFrame();
    const FrameTimes times = recorder.finish();
    EXPECT_GT(times.updateGpuMs, 0);
    EXPECT_GT(times.drawGpuMs, 0);
    EXPECT_NEAR(times.updateGpuMs + times.drawGpuMs, times.gpuMs, 1e-9);
    EXPECT_EQ(times.updateHostMs, 0);
    EXPECT_GE(times.drawHostMs, 3);
    EXPECT_NEAR(times.frameMs(), times.gpuMs + times.drawHostMs, 1e-9);
    EXPECT_EQ(namesOf(times), (std::vector<std::string>{"sort"}));
  }
}

TEST_F(RecorderTest, UpdatesWithoutGpuWorkTakeNoGpuTime) {
  Commands commands(device());
  FrameRecorder recorder(commands, StampMode::headline);
  recorder.beginFrame();
  {
    const Pass pass = recorder.hostPass("cull");
    sleepMs(2);
  }
  recorder.markUpdateDone();
  work(recorder, "draw");
  recorder.endFrame();
  const FrameTimes times = recorder.finish();
  EXPECT_EQ(times.updateGpuMs, 0);
  EXPECT_GE(times.updateHostMs, 2);
  EXPECT_EQ(times.drawGpuMs, times.gpuMs);
}

TEST_F(RecorderTest, BreakdownFramesTimeEveryPass) {
  Commands commands(device());
  FrameRecorder recorder(commands, StampMode::breakdown);
  recorder.beginFrame();
  work(recorder, "a", 4000);
  recorder.markUpdateDone();
  work(recorder, "b", 4000);
  work(recorder, "a", 4000);
  work(recorder, "b", 4000);
  recorder.endFrame();
  const FrameTimes times = recorder.finish();
  ASSERT_EQ(namesOf(times), (std::vector<std::string>{"a", "b"})); // equal names add up
  double sum = 0;
  for (const auto& pass : times.passes) {
    EXPECT_TRUE(pass.onGpu);
    EXPECT_GT(pass.ms, 0);
    sum += pass.ms;
  }
  EXPECT_LE(sum, times.gpuMs + 1e-9);
  EXPECT_GT(sum, 0.5 * times.gpuMs);
}

TEST_F(RecorderTest, StampsSurviveSubmissionsInsideAPass) {
  Commands commands(device());
  FrameRecorder recorder(commands, StampMode::breakdown);
  recorder.beginFrame();
  {
    const Pass pass = recorder.pass("build");
    record(recorder.gpu(), 1000);
    recorder.gpu().submitAndWait();
    sleepMs(5);
    record(recorder.gpu(), 1000);
  }
  work(recorder, "index");
  recorder.endFrame();
  const FrameTimes times = recorder.finish();
  ASSERT_EQ(namesOf(times), (std::vector<std::string>{"build", "index"}));
  EXPECT_GE(times.passes[0].ms, 5); // stamps at both ends, in two submissions
  EXPECT_GE(times.passes[0].hostMs, 5);
  EXPECT_GT(times.passes[1].ms, 0);
}

TEST_F(RecorderTest, PassesMustNotNest) {
  Commands commands(device());
  FrameRecorder recorder(commands);
  recorder.beginFrame();
  {
    const Pass outer = recorder.pass("outer");
    EXPECT_THROW(static_cast<void>(recorder.hostPass("inner")), std::logic_error);
    EXPECT_THROW(static_cast<void>(recorder.pass("inner")), std::logic_error);
  }
  EXPECT_NO_THROW(static_cast<void>(recorder.pass("after")));
  recorder.endFrame();
  recorder.finish();
}

TEST_F(RecorderTest, TooManyPassesAreRefusedBeforeStampsRunOut) {
  Commands commands(device());
  FrameRecorder recorder(commands, StampMode::breakdown);
  recorder.beginFrame();
  int passes = 0;
  try {
    for (; passes < 10000; ++passes)
      static_cast<void>(recorder.pass("many"));
  } catch (const std::logic_error&) {
  }
  EXPECT_GT(passes, 400);
  EXPECT_LT(passes, 10000);
  recorder.markUpdateDone();
  recorder.endFrame();
  EXPECT_GT(recorder.finish().gpuMs, 0);
}

TEST_F(RecorderTest, SelfTestTrustsThisDevice) {
  if (device().facts().timestampValidBits == 0) GTEST_SKIP() << "no timestamps";
  StampSelfTest test;
  for (int attempt = 0; attempt < 3 && !test.trusted; ++attempt)
    test = runStampSelfTest(device());
  EXPECT_TRUE(test.trusted) << describe(test);
}

TEST(HostRecorder, TimesPassesAndMarks) {
  HostRecorder recorder;
  recorder.beginFrame();
  {
    const Pass pass = recorder.hostPass("a");
    sleepMs(4);
  }
  recorder.markUpdateDone();
  sleepMs(2); // in no pass, but in draw
  for (int i = 0; i < 2; ++i) {
    const Pass pass = recorder.hostPass("b");
    sleepMs(2);
  }
  recorder.endFrame();
  sleepMs(20);
  const FrameTimes times = recorder.finish();
  EXPECT_TRUE(std::isnan(times.gpuMs));
  EXPECT_GE(times.updateMs(), 4);
  EXPECT_GE(times.drawMs(), 6);
  ASSERT_EQ(namesOf(times), (std::vector<std::string>{"a", "b"}));
  EXPECT_FALSE(times.passes[1].onGpu);
  EXPECT_GE(times.passes[1].ms, 4);
  EXPECT_LE(times.passes[1].ms, times.drawMs());
}

TEST(HostRecorder, OffersNoGpu) {
  HostRecorder recorder;
  recorder.beginFrame();
  EXPECT_THROW(recorder.gpu(), std::logic_error);
  EXPECT_THROW(static_cast<void>(recorder.pass("x")), std::logic_error);
}

} // namespace volmark::gpu::test
