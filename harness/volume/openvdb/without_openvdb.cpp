// Stands in for voxelise.cpp in builds without OpenVDB.
#include "volmark/error.h"
#include "volume/mesh/voxelise.h"

#include <fmt/format.h>

namespace volmark {

std::shared_ptr<const Volume> loadMesh(const std::filesystem::path& path, const MeshSettings&, std::uint64_t) {
  throw InputError(fmt::format("{}: meshes are voxelised by OpenVDB, and this volmark was built without it; install "
                               "libopenvdb-dev and build again",
                               path.string()));
}

} // namespace volmark
