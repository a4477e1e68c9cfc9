// Signed distance to a closed mesh, on a grid of any size.
#pragma once

#include "volmark/volume.h"

#include <filesystem>
#include <memory>

namespace volmark {

struct MeshSettings {
  int voxels = 256;    ///< along the longest side, with the margin; at least 16
  int bandVoxels = 16; ///< distances are clamped to this many voxels
};

/// float32 volume of the signed distance in mm to the mesh of an OFF file, positive inside, so that the surface is at
/// raw isovalue 0 and normals point outwards. Exact next to the surface; from one voxel on OpenVDB's nearest triangle
/// is not always the nearest (0.3 voxels off at most on a sphere). Voxels are cubes; a margin of 3 lies around the
/// mesh. Made by OpenVDB (meshToVolume), cached. Throws InputError: a bad or open mesh, over `maximumBytes`, built
/// without OpenVDB.
std::shared_ptr<const Volume> loadMesh(const std::filesystem::path& path, const MeshSettings& settings,
                                       std::uint64_t maximumBytes);

} // namespace volmark
