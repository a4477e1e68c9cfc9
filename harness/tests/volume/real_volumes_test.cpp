// The volumes of the scene files, where VOLMARK_DATA has them.
#include "volume/nrrd.h"
#include "volume/volume_files.h"

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <sstream>

namespace volmark::test {
namespace {

struct Known {
  const char* name;
  glm::ivec3 dims;
  glm::dvec3 spacingMm;
  ScalarType type;
  Range range;
};
void PrintTo(const Known& known, std::ostream* out) {
  *out << known.name;
}

const Known kKnown[] = {
    {"aneurism", {256, 256, 256}, {1, 1, 1}, ScalarType::uint8, {0, 255}},
    {"bonsai", {256, 256, 256}, {1, 1, 1}, ScalarType::uint8, {0, 255}},
    {"neghip", {64, 64, 64}, {1, 1, 1}, ScalarType::uint8, {0, 255}},
    {"chest_ct", {256, 256, 138}, {1.5625, 1.5625, 2}, ScalarType::int16, {-1000, 1902}},
    {"kingsnake", {256, 256, 199}, {0.12696, 0.12696, 0.27485427}, ScalarType::uint8, {0, 255}},
    {"stag_beetle", {416, 208, 124}, {2, 4, 3.983871}, ScalarType::uint16, {0, 3614}},
    {"chameleon", {256, 256, 135}, {0.36914062, 0.36914062, 0.84}, ScalarType::uint16, {0, 65535}},
    {"vertebra", {256, 256, 256}, {0.3906, 0.3906, 0.3906}, ScalarType::uint16, {0, 3128}},
    {"backpack", {256, 256, 187}, {1.9532, 1.9532, 2.4933155}, ScalarType::uint16, {0, 4929}},
    {"mri_ventricles", {256, 256, 124}, {0.9, 0.9, 0.9}, ScalarType::uint8, {0, 255}},
    {"vis_male", {128, 256, 256}, {1.57774, 0.995861, 1.00797}, ScalarType::uint8, {0, 255}},
};

std::optional<std::filesystem::path> findInData(const std::string& file) {
  const char* folders = std::getenv("VOLMARK_DATA");
  std::istringstream list(folders ? folders : "");
  for (std::string folder; std::getline(list, folder, ':');)
    if (std::filesystem::exists(std::filesystem::path(folder) / file)) return std::filesystem::path(folder) / file;
  return std::nullopt;
}

class RealVolumes : public testing::TestWithParam<Known> {};

TEST_P(RealVolumes, HaveTheirShapeAndRange) {
  const Known& known = GetParam();
  const auto path = findInData(std::string(known.name) + ".nrrd");
  if (!path) GTEST_SKIP() << known.name << ".nrrd is not in VOLMARK_DATA";
  const auto volume = loadNrrd(*path, std::uint64_t(1) << 30);
  EXPECT_EQ(volume->grid().dims, known.dims);
  EXPECT_LT(glm::length(volume->grid().spacingMm - known.spacingMm), 1e-6);
  EXPECT_EQ(volume->type(), known.type);
  EXPECT_EQ(volume->dataRange().minimum, known.range.minimum);
  EXPECT_EQ(volume->dataRange().maximum, known.range.maximum);
}

INSTANTIATE_TEST_SUITE_P(All, RealVolumes, testing::ValuesIn(kKnown), [](const auto& test) { return test.param.name; });

} // namespace
} // namespace volmark::test
