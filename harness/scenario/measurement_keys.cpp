#include "scenario/key_makers.h"

namespace volmark {

namespace {

bool inFrames(const PointSettings& settings) {
  return settings.pacing.mode == PacingSettings::Mode::frames;
}

bool timed(const PointSettings& settings) {
  return settings.pacing.mode == PacingSettings::Mode::timed;
}

} // namespace

std::vector<PointKey> measurementKeys() {
  using namespace keys;
  using Mode = PacingSettings::Mode;
  return {
      choice(
          "pacing.mode", [](auto& s) -> auto& { return s.pacing.mode; },
          std::vector<std::pair<std::string, Mode>>{{"frames", Mode::frames}, {"timed", Mode::timed}},
          "frames: equal steps, the same phases for all; timed: the phase follows the clock."),
      onlyIf(inFrames, integer(
                           "pacing.frames", [](auto& s) -> auto& { return s.pacing.frames; }, 1, 100000,
                           "Frames of one pass over the timeline (an orbit).")),
      onlyIf(inFrames, integer(
                           "pacing.warm_up_frames", [](auto& s) -> auto& { return s.pacing.warmUpFrames; }, 3, 10000,
                           "Frames drawn before the first timed one.")),
      onlyIf(inFrames, integer(
                           "pacing.orbits", [](auto& s) -> auto& { return s.pacing.orbits; }, 1, 1000,
                           "Timed passes over the timeline per process.")),
      onlyIf(timed, number(
                        "pacing.warm_up_seconds", [](auto& s) -> auto& { return s.pacing.warmUpSeconds; }, 0, 600, "s",
                        "Time drawn before the first timed frame, and at least 3 frames.")),
      onlyIf(timed, number(
                        "pacing.seconds", [](auto& s) -> auto& { return s.pacing.seconds; }, 0.1, 3600, "s",
                        "Length of the timeline.")),

      integer(
          "measure.replicates", [](auto& s) -> auto& { return s.measure.replicates; }, 1, 1000,
          "Processes that repeat the point."),
      integer(
          "measure.breakdown_orbits", [](auto& s) -> auto& { return s.measure.breakdownOrbits; }, 0, 1000,
          "Extra orbits with a stamp per pass."),
      integer(
          "measure.frames_in_flight", [](auto& s) -> auto& { return s.measure.framesInFlight; }, 1, 8,
          "1 measures latency, more measures throughput."),
      integer(
          "measure.seed", [](auto& s) -> auto& { return s.measure.seed; }, 0, std::int64_t(1) << 53,
          "Seed of all random numbers."),
      number(
          "measure.time_limit_seconds", [](auto& s) -> auto& { return s.measure.timeLimitSeconds; }, 1, 86400, "s",
          "A run that takes longer is ended."),
      number(
          "measure.memory_limit_gib", [](auto& s) -> auto& { return s.measure.memoryLimitGib; }, 0, 1 << 20, "GiB",
          "A run whose process takes more private memory is ended; 0 is no limit."),
      choice(
          "measure.isolation", [](auto& s) -> auto& { return s.measure.isolation; },
          std::vector<std::pair<std::string, MeasureSettings::Isolation>>{
              {"run", MeasureSettings::Isolation::run}, {"volume", MeasureSettings::Isolation::volume}},
          "run: a process for each run; volume: a process draws all runs of a volume until something goes wrong."),
      integer(
          "measure.interleave", [](auto& s) -> auto& { return s.measure.interleave; }, 1, 64,
          "Most worker processes alive at once."),

      integer(
          "pictures.count", [](auto& s) -> auto& { return s.pictures.count; }, 0, 1000,
          "Captured frames, spread evenly over the timeline."),
      derived(choice(
                  "pictures.reference", [](auto& s) -> auto& { return s.pictures.reference; },
                  std::vector<std::pair<std::string, std::string>>{{"cpu", "cpu"}, {"none", "none"}},
                  "What pictures are compared with."),
              "cpu; none with shadows, where it takes minutes"),
      vector(
          "pictures.background", [](auto& s) -> auto& { return s.pictures.background; }, 0, 1,
          "Colour behind the picture for errors and sheets, linear Rec.709."),
  };
}

} // namespace volmark
