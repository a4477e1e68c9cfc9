// Triangle meshes as files that other programs read.
#pragma once

#include "volmark/surface_mesh.h"

#include <filesystem>
#include <string>

namespace volmark {

/// By the file's ending: .ply (binary, little endian) or .glb (binary glTF 2.0). Written beside and renamed, so that
/// nothing half-written stays. Throws InputError for another ending, a mesh without triangles, and a file that can't be
/// written; UnsupportedError for a glTF file over 4 GiB. `comment`: a line of where the mesh comes from.
void writeMesh(const std::filesystem::path& path, const SurfaceMesh& mesh, const std::string& comment);

/// Throws InputError unless writeMesh() knows the ending.
void requireMeshEnding(const std::filesystem::path& path);

} // namespace volmark
