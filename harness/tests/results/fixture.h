// An experiment made by hand: two techniques that draw nothing, a grid of points, a record with every field.
#pragma once

#include "results/experiment.h"
#include "results/files.h"
#include "results/provenance.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <unistd.h>

namespace volmark::results_test {

namespace fs = std::filesystem;

/// A folder that goes away with the test; in memory if possible, where waiting for the disk costs nothing and
/// kills meet every step of a commit alike.
class TemporaryFolder {
public:
  TemporaryFolder() {
    const bool hasMemory = access("/dev/shm", W_OK | X_OK) == 0;
    std::string name = (hasMemory ? "/dev/shm" : testing::TempDir()) + std::string("/volmark_results_XXXXXX");
    const char* made = mkdtemp(name.data());
    EXPECT_NE(made, nullptr) << name;
    m_path = made ? made : "";
  }
  ~TemporaryFolder() {
    std::error_code error;
    if (getpid() == m_owner) fs::remove_all(m_path, error);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return m_path; }

private:
  fs::path m_path;
  pid_t m_owner = getpid();
};

inline std::string readText(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

inline TechniqueFactory fakeFactory(const std::string& name) {
  TechniqueFactory factory;
  factory.info.name = name;
  factory.info.summary = "Draws \"nothing\", quickly";
  factory.info.paper = "Nobody: Nothing, 2000";
  factory.info.section = "3.1";
  factory.info.history = History::visible;
  factory.info.passes = {{"march", "All of it."}, {"never", "Declared but never recorded."}};
  factory.info.generation = {{"build", "Nothing."}};
  factory.info.counters = {{"samples", CounterKind::perDevice, "Samples taken."}};
  return factory;
}

inline CatalogueEntry entryOf(const TechniqueFactory& factory) {
  return {&factory, "fake", "fake.so", "00112233445566778899aabbccddeeff"};
}

inline Point makePointOf(const std::string& technique, double step) {
  Point point;
  point.config = {{"technique", {{"name", technique}, {"parameters", {{"step", step}}}}},
                  {"scene", "sphere"},
                  {"measure", {{"replicates", 5}}}};
  point.labels = {{"technique", technique}, {"step", nlohmann::json(step).dump()}};
  point.group = "step " + nlohmann::json(step).dump();
  return point;
}

inline Scenario makeScenario(const std::string& name = "quick") {
  Scenario scenario;
  scenario.name = name;
  scenario.title = "Quick";
  scenario.file = "/some/where/quick.json";
  scenario.assignments = {"pacing.frames=4"};
  scenario.document = {{"volmark", 1}, {"name", name}};
  scenario.axes = {"technique", "step"};
  for (const char* technique : {"fake_a", "fake_b"})
    for (double step : {0.5, 1.0})
      scenario.points.push_back(makePointOf(technique, step));
  for (std::size_t i = 0; i < scenario.points.size(); ++i)
    scenario.points[i].index = static_cast<int>(i);
  return scenario;
}

inline RunIdentity identityOf(const Point& point, int replicate = 0, const std::string& build = "build") {
  const std::string hash = pointHash(point.config, "voxels");
  return {hash, runHash(hash, build, "host", replicate), replicate};
}

/// `orbits` headline orbits and a breakdown orbit of `frames` frames. Times are odd fractions on purpose.
inline RunRecord makeRecord(int frames = 4, int orbits = 3, double scale = 1) {
  RunRecord record;
  for (int orbit = 0; orbit <= orbits; ++orbit) {
    for (int frame = 0; frame < frames; ++frame) {
      FrameRow row;
      row.orbitKind = orbit < orbits ? OrbitKind::headline : OrbitKind::breakdown;
      row.orbit = orbit;
      row.frame = frame;
      row.phase = static_cast<double>(frame) / frames;
      row.drawMs = scale * (5 + std::sin(frame * 1.7 + orbit) / 3);
      row.updateMs = 0;
      row.frameMs = row.drawMs;
      row.hostMs = row.frameMs * 1.1;
      row.cpuMs = row.frameMs * 1.9;
      row.intervalMs = frame == 0 ? std::nan("") : row.hostMs + 0.1;
      row.gpuMs = std::nan("");
      if (frame == 1) row.disturbed = "switches+steal";
      if (orbit == orbits) row.passes = {{"march", row.drawMs / 2}, {"march", row.drawMs / 2}};
      record.frames.push_back(row);
    }
  }
  record.counters = {{0, 0.0, {{"samples", 1000}}}, {1, 0.25, {{"samples", 18446744073709551615u}}}};
  record.generation = {{"build", 12.5, std::nan("")}, {"upload", 1.25, 0.75}};
  record.prepareMs = 14;
  record.firstFrameMs = 7;
  record.memory = {{"texture", 1 << 20}, {"table", 4096}};
  record.ledgerBytes = (1 << 20) + 4096;
  record.ledgerPeakBytes = 1 << 21;
  record.checks = {{"timed_frame_equals_replay", true, "bitwise"}};
  record.provenance = provenance(nullptr);
  return record;
}

/// Adds a picture to the record and its file to the stage.
inline void addPicture(RunRecord& record, const fs::path& stage, const PictureErrors& errors) {
  PictureRow picture;
  picture.frame = static_cast<int>(record.pictures.size());
  picture.file = fmt::format("frame_{}.exr", picture.frame);
  picture.reference = "cpu";
  picture.referenceFile = "references/abc.exr";
  picture.errors = errors;
  picture.cumulativeMs = 20.125;
  record.pictures.push_back(picture);
  std::ofstream(stage / picture.file) << "picture";
}

inline std::vector<std::string> namesIn(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    names.push_back(entry.path().filename().string());
  return names;
}

inline bool pythonHas(const std::string& module) {
  return std::system(fmt::format("/usr/bin/python3 -c 'import {}' 2>/dev/null", module).c_str()) == 0;
}

/// Runs a Python program with arguments; its exit status and all it printed.
inline std::pair<int, std::string> runPython(const fs::path& folder, const std::string& program,
                                             const std::string& arguments) {
  const fs::path script = folder / "script.py";
  std::ofstream(script) << program;
  std::FILE* output = popen(fmt::format("/usr/bin/python3 '{}' {} 2>&1", script.string(), arguments).c_str(), "r");
  if (!output) return {-1, "popen failed"};
  std::string text;
  char buffer[4096];
  while (const std::size_t bytes = std::fread(buffer, 1, sizeof buffer, output))
    text.append(buffer, bytes);
  return {pclose(output), text};
}

} // namespace volmark::results_test
