#include "gpu_test.h"
#include "volmark/error.h"
#include "volmark/gpu/frame_recorder.h"
#include "volmark/gpu/volume_texture.h"
#include "volmark/shared/frame_constants.h"
#include "volumes.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace volmark::gpu::test {

namespace {

using glm::dvec3;

constexpr ScalarType kTypes[] = {ScalarType::int8, ScalarType::uint8, ScalarType::int16, ScalarType::uint16,
                                 ScalarType::float32};

class VolumeTextureTest : public GpuTest {
protected:
  VolumeTexture upload(const Scene& scene, Filtering filtering, int first = 0, int count = 1) {
    Commands commands(device());
    FrameRecorder recorder(commands, StampMode::breakdown);
    recorder.beginFrame();
    VolumeTexture texture(device(), scene, filtering, recorder, first, count);
    recorder.endFrame();
    const FrameTimes times = recorder.finish();
    EXPECT_EQ(times.passes.size(), 1u);
    EXPECT_EQ(times.passes.at(0).name, "upload");
    return texture;
  }

  FrameConstants constantsOf(const Scene& scene, const VolumeTexture& texture) {
    const Grid& grid = scene.volume->grid();
    FrameConstants constants{};
    constants.boxMinimum = vec3(grid.boxMinimum());
    constants.boxMaximum = vec3(grid.boxMaximum());
    constants.spacing = vec3(grid.spacingMm);
    constants.dims = grid.dims;
    constants.valueScale = texture.scale();
    constants.valueBias = texture.bias();
    return constants;
  }

  /// vec4(gradient, value) at world positions.
  std::vector<vec4> sample(const Scene& scene, const VolumeTexture& texture, const SampledImage& image,
                           const std::vector<vec3>& positions) {
    const Buffer frame = bufferOf<FrameConstants>({constantsOf(scene, texture)});
    const Buffer input = bufferOf(positions);
    return evaluate<vec4>("vec4", positions.size(),
                          "#include <volmark/volume.glsl>\nVOLMARK_FRAME(1)\n"
                          "layout(binding = 2) uniform sampler3D volume;\n"
                          "layout(binding = 3, scalar) readonly buffer Positions { vec3 positions[]; };\n"
                          "layout(constant_id = 0) const bool kShaderFiltering = false;",
                          "VolumeGrid grid = volumeGrid(frame);\n"
                          "result[i] = vec4(sampleGradient(volume, grid, positions[i], kShaderFiltering),\n"
                          "                 sampleVolume(volume, grid, positions[i], kShaderFiltering));",
                          {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                           VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
                          {frame.range(), image, input.range()},
                          Specialisation().set(0, texture.filtering() == Filtering::shader));
  }

  std::vector<Filtering> filteringsFor(const Scene& scene) {
    std::vector<Filtering> result;
    for (const Filtering filtering : {Filtering::hardware, Filtering::shader})
      if (!VolumeTexture::whyUnsupported(device(), *scene.volume, filtering)) result.push_back(filtering);
    EXPECT_FALSE(result.empty());
    return result;
  }
};

std::vector<vec3> voxelCentres(const Grid& grid) {
  std::vector<vec3> positions;
  for (int k = 0; k < grid.dims.z; ++k)
    for (int j = 0; j < grid.dims.y; ++j)
      for (int i = 0; i < grid.dims.x; ++i)
        positions.emplace_back(grid.toWorld({i, j, k}));
  return positions;
}

/// Inside the box, the middles of cells and a little beyond the sides.
std::vector<vec3> scatteredPositions(const Grid& grid) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<vec3> positions;
  for (int i = 0; i < 400; ++i) {
    const dvec3 place(uniform(random), uniform(random), uniform(random));
    positions.emplace_back(grid.toWorld(place * dvec3(grid.dims - 1)));
    positions.emplace_back(
        grid.toWorld(glm::min(glm::floor(place * dvec3(grid.dims - 1)) + 0.5, dvec3(grid.dims - 1))));
  }
  return positions;
}

/// Of a value in [0,1]: hardware filters may interpolate with 8-bit weights along each axis.
double toleranceOf(Filtering filtering) {
  return filtering == Filtering::shader ? 2e-6 : 3.0 / 256;
}

} // namespace

TEST_F(VolumeTextureTest, VoxelCentresKeepTheirValues) {
  for (const ScalarType type : kTypes) {
    const Scene scene = sceneOf(randomVolume(type, {7, 5, 6}, {1.0, 0.7, 1.9}));
    const auto positions = voxelCentres(scene.volume->grid());
    for (const Filtering filtering : filteringsFor(scene)) {
      SCOPED_TRACE(std::string(nameOf(type)) + (filtering == Filtering::shader ? " shader" : " hardware"));
      const VolumeTexture texture = upload(scene, filtering);
      const auto found = sample(scene, texture, texture.at(0), positions);
      // At a centre all weight is on one voxel; 8-bit weights or not, one step of uint8 is the most to lose.
      const double tolerance = filtering == Filtering::shader ? 2e-6 : 0.5 / 256;
      for (std::size_t i = 0; i < positions.size(); ++i)
        ASSERT_NEAR(found[i].w, fieldAt(scene, positions[i]), tolerance) << "voxel " << i;
    }
  }
}

TEST_F(VolumeTextureTest, SignedExtremesStayApart) {
  // SNORM would map the two lowest values of each type to one.
  for (const ScalarType type : {ScalarType::int8, ScalarType::int16}) {
    Scene scene = sceneOf(randomVolume(type, {3, 1, 1}, dvec3(1))); // lowest, lowest + 1, largest
    const double lowest = type == ScalarType::int8 ? -128 : -32768;
    scene.visualisationRange = {lowest, lowest + 2};
    const VolumeTexture texture = upload(scene, Filtering::shader);
    const auto found = sample(scene, texture, texture.at(0), voxelCentres(scene.volume->grid()));
    EXPECT_NEAR(found[0].w, 0.0, 1e-5) << nameOf(type);
    EXPECT_NEAR(found[1].w, 0.5, 4e-3) << nameOf(type);
    EXPECT_EQ(found[2].w, 1.0f) << nameOf(type);
  }
}

TEST_F(VolumeTextureTest, InterpolatesTrilinearlyAndClampsAfterwards) {
  for (const ScalarType type : kTypes) {
    Scene scene = sceneOf(randomVolume(type, {9, 8, 7}, {0.5, 1.0, 1.5}));
    // A narrow range: clamping before interpolation would be far off.
    const Range data = scene.visualisationRange;
    const double width = data.maximum - data.minimum;
    scene.visualisationRange = {data.minimum + 0.3 * width, data.minimum + 0.8 * width};
    const auto positions = scatteredPositions(scene.volume->grid());
    for (const Filtering filtering : filteringsFor(scene)) {
      SCOPED_TRACE(std::string(nameOf(type)) + (filtering == Filtering::shader ? " shader" : " hardware"));
      const VolumeTexture texture = upload(scene, filtering);
      const auto found = sample(scene, texture, texture.at(0), positions);
      for (std::size_t i = 0; i < positions.size(); ++i)
        ASSERT_NEAR(found[i].w, fieldAt(scene, positions[i]), 2 * toleranceOf(filtering)) << "position " << i;
    }
  }
}

TEST_F(VolumeTextureTest, GradientsAreCentralDifferencesOfTheClampedField) {
  Scene scene = sceneOf(randomVolume(ScalarType::float32, {9, 8, 7}, {0.5, 1.0, 1.5}));
  scene.visualisationRange = {-2, 3};
  auto positions = scatteredPositions(scene.volume->grid());
  for (const vec3& corner : voxelCentres(scene.volume->grid()))
    positions.push_back(corner);
  const VolumeTexture texture = upload(scene, Filtering::shader);
  const auto found = sample(scene, texture, texture.at(0), positions);
  for (std::size_t i = 0; i < positions.size(); ++i)
    ASSERT_LT(glm::distance(dvec3(found[i]), gradientAt(scene, positions[i])), 2e-5) << "position " << i;
}

TEST_F(VolumeTextureTest, AxesOfOneVoxelHaveNoGradient) {
  const Scene scene = sceneOf(randomVolume(ScalarType::uint16, {1, 6, 1}, dvec3(2)));
  const VolumeTexture texture = upload(scene, Filtering::shader);
  const auto positions = voxelCentres(scene.volume->grid());
  const auto found = sample(scene, texture, texture.at(0), positions);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    EXPECT_EQ(found[i].x, 0);
    EXPECT_EQ(found[i].z, 0);
    EXPECT_NEAR(found[i].y, gradientAt(scene, positions[i]).y, 1e-5);
  }
}

TEST_F(VolumeTextureTest, HoldsAndReplacesTimeSteps) {
  const Scene scene = sceneOf(randomVolume(ScalarType::int16, {4, 4, 4}, dvec3(1), 5));
  const auto positions = voxelCentres(scene.volume->grid());
  VolumeTexture texture = upload(scene, Filtering::shader, 1, 2);
  const auto expectStep = [&](const SampledImage& image, int step) {
    const auto found = sample(scene, texture, image, positions);
    for (std::size_t i = 0; i < positions.size(); ++i)
      ASSERT_NEAR(found[i].w, fieldAt(scene, positions[i], step), 2e-6);
  };
  expectStep(texture.at(1), 1);
  expectStep(texture.at(2), 2);
  Commands commands(device());
  commands.begin();
  texture.upload(commands, *scene.volume, 4, 0);
  commands.submit();
  commands.wait();
  expectStep(texture.slot(0), 4);
  expectStep(texture.slot(1), 2);
}

TEST_F(VolumeTextureTest, LargeVolumesAreStagedInSlabs) {
  // 320 x 320 x 400 of 16 bits are 78 MiB: two slabs.
  const glm::ivec3 dims(320, 320, 400);
  const Scene scene = [&] {
    std::vector<std::byte> bytes(std::size_t(320) * 320 * 400 * 2);
    for (std::size_t i = 0; i < bytes.size() / 2; ++i) {
      const auto value = static_cast<std::uint16_t>(i * 40503u >> 4);
      std::memcpy(bytes.data() + 2 * i, &value, 2);
    }
    return sceneOf(std::make_shared<Volume>("large", Grid{dims, dvec3(1)}, ScalarType::uint16, std::move(bytes)));
  }();
  if (VolumeTexture::whyUnsupported(device(), *scene.volume, Filtering::shader)) GTEST_SKIP();
  const VolumeTexture texture = upload(scene, Filtering::shader);
  EXPECT_GE(texture.bytes(), std::size_t(320) * 320 * 400 * 2);
  std::vector<vec3> positions;
  for (int k = 0; k < 400; ++k)
    positions.emplace_back(scene.volume->grid().toWorld({k * 7 % 320, k * 13 % 320, k}));
  const auto found = sample(scene, texture, texture.at(0), positions);
  for (std::size_t i = 0; i < positions.size(); ++i)
    ASSERT_NEAR(found[i].w, fieldAt(scene, positions[i]), 2e-6) << i;
}

TEST_F(VolumeTextureTest, TooLongAxesAreRefused) {
  const int most = static_cast<int>(device().facts().maximumImageDimension3D);
  const auto volume = randomVolume(ScalarType::uint8, {most + 1, 1, 1}, dvec3(1));
  const auto why = VolumeTexture::whyUnsupported(device(), *volume, Filtering::shader);
  ASSERT_TRUE(why);
  EXPECT_NE(why->find(std::to_string(most)), std::string::npos);
  EXPECT_THROW(upload(sceneOf(volume), Filtering::shader), UnsupportedError);
}

} // namespace volmark::gpu::test
