// Triangle meshes, only as a source of volumes.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <filesystem>
#include <vector>

namespace volmark {

struct Mesh {
  std::vector<glm::vec3> points;     ///< mm, in the file's own axes
  std::vector<glm::uvec3> triangles; ///< counter-clockwise seen from outside
};

/// Object File Format, text (OFF, also with colours, which are dropped); faces of more corners become fans. At most
/// `maximumBytes` of points and triangles. Throws InputError: not OFF, counts that the file is too short for, a corner
/// that is no point, a coordinate that is no finite number.
Mesh readOff(const std::filesystem::path& path, std::uint64_t maximumBytes);

/// Throws InputError, prefixed with the file's name, unless every edge has one triangle on each side, in opposite
/// directions: only then it has an inside.
void requireClosed(const std::filesystem::path& path, const Mesh& mesh);

} // namespace volmark
