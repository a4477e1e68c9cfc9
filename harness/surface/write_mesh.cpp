#include "surface/write_mesh.h"

#include "results/files.h"
#include "volmark/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <string>

namespace volmark {

namespace {

static_assert(std::endian::native == std::endian::little, "both formats are little-endian");

template <class Element> void append(std::string& bytes, const Element& element) {
  bytes.append(reinterpret_cast<const char*>(&element), sizeof(Element));
}

template <class Element> void append(std::string& bytes, const std::vector<Element>& elements) {
  bytes.append(reinterpret_cast<const char*>(elements.data()), elements.size() * sizeof(Element));
}

std::string plyOf(const SurfaceMesh& mesh, const std::string& comment) {
  std::string bytes = fmt::format("ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\n"
                                  "property float x\nproperty float y\nproperty float z\n"
                                  "property float nx\nproperty float ny\nproperty float nz\n"
                                  "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                                  comment, mesh.positions.size(), mesh.triangles.size());
  bytes.reserve(bytes.size() + 24 * mesh.positions.size() + 13 * mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    append(bytes, mesh.positions[i]);
    append(bytes, mesh.normals[i]);
  }
  for (const glm::uvec3& triangle : mesh.triangles) {
    bytes.push_back(3);
    append(bytes, triangle);
  }
  return bytes;
}

/// glTF wants unit normals: where the field has no gradient, any will do.
std::vector<glm::vec3> unitNormals(std::vector<glm::vec3> normals) {
  for (glm::vec3& normal : normals)
    if (glm::dot(normal, normal) < 0.5f) normal = {0, 0, 1};
  return normals;
}

nlohmann::json describeGltf(const SurfaceMesh& mesh, const std::string& comment) {
  glm::vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
  for (const glm::vec3& position : mesh.positions) {
    low = glm::min(low, position);
    high = glm::max(high, position);
  }
  const auto numbers = [](const glm::vec3& v) { return nlohmann::json{v.x, v.y, v.z}; };
  const std::size_t vertices = mesh.positions.size(), vertexBytes = 12 * vertices;
  const std::size_t indexBytes = 12 * mesh.triangles.size();
  constexpr int kFloat = 5126, kUint32 = 5125, kVertexTarget = 34962, kIndexTarget = 34963;
  return {
      {"asset", {{"version", "2.0"}, {"generator", "volmark"}, {"extras", {{"comment", comment}}}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      // Millimetres to metres.
      {"nodes", {{{"mesh", 0}, {"scale", {0.001, 0.001, 0.001}}}}},
      {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", 2}, {"mode", 4}}}}}}},
      {"accessors",
       {{{"bufferView", 0},
         {"componentType", kFloat},
         {"count", vertices},
         {"type", "VEC3"},
         {"min", numbers(low)},
         {"max", numbers(high)}},
        {{"bufferView", 1}, {"componentType", kFloat}, {"count", vertices}, {"type", "VEC3"}},
        {{"bufferView", 2}, {"componentType", kUint32}, {"count", 3 * mesh.triangles.size()}, {"type", "SCALAR"}}}},
      {"bufferViews",
       {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", vertexBytes}, {"target", kVertexTarget}},
        {{"buffer", 0}, {"byteOffset", vertexBytes}, {"byteLength", vertexBytes}, {"target", kVertexTarget}},
        {{"buffer", 0}, {"byteOffset", 2 * vertexBytes}, {"byteLength", indexBytes}, {"target", kIndexTarget}}}},
      {"buffers", {{{"byteLength", 2 * vertexBytes + indexBytes}}}}};
}

std::string glbOf(const SurfaceMesh& mesh, const std::string& comment) {
  std::string json = describeGltf(mesh, comment).dump();
  json.append((4 - json.size() % 4) % 4, ' ');
  const std::uint64_t binary = 24 * mesh.positions.size() + 12 * mesh.triangles.size();
  const std::uint64_t total = 12 + 8 + json.size() + 8 + binary;
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw UnsupportedError(fmt::format("glTF files hold 4 GiB, this mesh needs {} bytes: write a .ply file", total));
  std::string bytes = "glTF";
  bytes.reserve(total);
  append(bytes, std::uint32_t{2});
  append(bytes, static_cast<std::uint32_t>(total));
  append(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  append(bytes, static_cast<std::uint32_t>(binary));
  bytes.append("BIN\0", 4);
  append(bytes, mesh.positions);
  append(bytes, unitNormals(mesh.normals));
  append(bytes, mesh.triangles);
  return bytes;
}

} // namespace

void requireMeshEnding(const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  if (ending != ".ply" && ending != ".glb")
    throw InputError(fmt::format("{}: found the ending \"{}\", allowed: .ply, .glb (glTF)", path.string(), ending));
}

void writeMesh(const std::filesystem::path& path, const SurfaceMesh& mesh, const std::string& comment) {
  requireMeshEnding(path);
  if (mesh.triangles.empty()) throw InputError(fmt::format("{}: there is no surface to write", path.string()));
  replaceFile(path, path.extension() == ".ply" ? plyOf(mesh, comment) : glbOf(mesh, comment));
}

} // namespace volmark
