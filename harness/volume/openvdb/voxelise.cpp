// The only file that sees OpenVDB.
#include "volume/mesh/voxelise.h"

#include "volmark/error.h"
#include "volume/mesh/mesh.h"
#include "volume/volume_cache.h"
#include "volume/voxel_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/MeshToVolume.h>

namespace volmark {

namespace {

constexpr int kMargin = 3;

struct Frame {
  Grid grid;
  glm::dvec3 firstVoxel; ///< in the mesh's axes
};

Frame frameOf(const std::filesystem::path& path, const Mesh& mesh, const MeshSettings& settings) {
  glm::dvec3 low(std::numeric_limits<double>::max());
  glm::dvec3 high(std::numeric_limits<double>::lowest());
  for (const glm::vec3& point : mesh.points) {
    low = glm::min(low, glm::dvec3(point));
    high = glm::max(high, glm::dvec3(point));
  }
  const glm::dvec3 size = high - low;
  const double longest = std::max({size.x, size.y, size.z});
  if (!(longest > 0)) throw InputError(fmt::format("{}: all points are in one place", path.string()));
  const double spacing = longest / (settings.voxels - 1 - 2 * kMargin);
  Frame frame;
  frame.grid.spacingMm = glm::dvec3(spacing);
  // The longest side has no rounding to suffer from.
  for (int axis = 0; axis < 3; ++axis)
    frame.grid.dims[axis] =
        std::min(settings.voxels, static_cast<int>(std::ceil(size[axis] / spacing - 1e-9)) + 1 + 2 * kMargin);
  frame.firstVoxel = 0.5 * (low + high) - 0.5 * frame.grid.extentMm();
  return frame;
}

std::shared_ptr<const Volume> voxelise(const std::filesystem::path& path, const MeshSettings& settings,
                                       std::uint64_t maximumBytes) {
  const Mesh mesh = readOff(path, maximumBytes);
  requireClosed(path, mesh);
  const Frame frame = frameOf(path, mesh, settings);
  const std::uint64_t bytes = checkedVoxelBytes(path.string(), frame.grid, ScalarType::float32, 1, maximumBytes);

  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  for (const glm::vec3& point : mesh.points) {
    const glm::dvec3 voxel = (glm::dvec3(point) - frame.firstVoxel) / frame.grid.spacingMm;
    points.emplace_back(float(voxel.x), float(voxel.y), float(voxel.z));
  }
  std::vector<openvdb::Vec3I> triangles;
  for (const glm::uvec3& t : mesh.triangles)
    triangles.emplace_back(t.x, t.y, t.z);
  // In voxel coordinates, so that distances come in voxels.
  const auto band = static_cast<float>(settings.bandVoxels);
  const auto distance = openvdb::tools::meshToSignedDistanceField<openvdb::FloatGrid>(
      *openvdb::math::Transform::createLinearTransform(1.0), points, triangles, {}, band, band);

  std::vector<std::byte> voxels = allocateVoxels(path.string(), bytes);
  auto* const values = reinterpret_cast<float*>(voxels.data());
  const glm::ivec3 last = frame.grid.dims - 1;
  openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(openvdb::CoordBBox({0, 0, 0}, {last.x, last.y, last.z}),
                                                                values);
  openvdb::tools::copyToDense(*distance, dense);
  const auto spacing = static_cast<float>(frame.grid.spacingMm.x);
  // OpenVDB's distances are negative inside.
  for (std::size_t i = 0; i < frame.grid.voxelCount(); ++i)
    values[i] = -std::clamp(values[i], -band, band) * spacing;
  return std::make_shared<const Volume>(path.filename().string(), frame.grid, ScalarType::float32, std::move(voxels));
}

} // namespace

std::shared_ptr<const Volume> loadMesh(const std::filesystem::path& path, const MeshSettings& settings,
                                       std::uint64_t maximumBytes) {
  const std::string key = fmt::format("mesh, {} voxels, band {}", settings.voxels, settings.bandVoxels);
  return cachedVolume({path}, key, maximumBytes, [&] { return voxelise(path, settings, maximumBytes); });
}

} // namespace volmark
