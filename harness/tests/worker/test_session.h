// Sessions of the test techniques, for the tests of this folder.
#pragma once

#include "technique/catalogue.h"
#include "worker/session.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>

namespace volmark::test {

/// Modules of test techniques only, loaded once.
inline const TechniqueCatalogue& catalogue() {
  static const TechniqueCatalogue loaded({VOLMARK_BINARY_DIR "/tests/techniques"});
  return loaded;
}

/// A ramp along x plus `timeStep` * 10, so that every step and voxel differs.
inline std::shared_ptr<const Volume> rampVolume(int n = 8, int timeSteps = 1) {
  std::vector<std::byte> bytes;
  for (int step = 0; step < timeSteps; ++step)
    for (int i = 0; i < n * n * n; ++i)
      bytes.push_back(static_cast<std::byte>(i % n * 4 + step * 10));
  return std::make_shared<Volume>("ramp", Grid{glm::ivec3(n), glm::dvec3(1)}, ScalarType::uint8, std::move(bytes),
                                  timeSteps);
}

inline PointSettings settingsFor(const std::string& technique, int width = 24, int height = 16) {
  PointSettings settings;
  settings.technique = technique;
  settings.parameters = ParameterValues(catalogue().get(technique).factory->info.parameters);
  settings.transferFunction =
      std::make_shared<TransferFunction>("ramp", std::vector<ControlPoint>{{0, {1, 1, 1}, 0}, {1, {1, 1, 1}, 1}});
  settings.width = width;
  settings.height = height;
  settings.shading.model = ShadingModel::none;
  return settings;
}

inline bool equalBits(const std::vector<Picture>& a, const std::vector<Picture>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t view = 0; view < a.size(); ++view)
    if (std::memcmp(a[view].color.data(), b[view].color.data(), a[view].color.size() * sizeof(glm::vec4)) != 0)
      return false;
  return true;
}

inline bool hasDevice() {
  for (const gpu::DeviceFacts& facts : gpu::listDevices())
    if (facts.missing.empty()) return true;
  return false;
}

/// Skips the rest of a test where no Vulkan device is.
#define NEEDS_DEVICE()                                                                                                 \
  if (!volmark::test::hasDevice()) GTEST_SKIP() << "no Vulkan device"

} // namespace volmark::test
