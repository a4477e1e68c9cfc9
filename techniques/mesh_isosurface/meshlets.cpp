#include "meshlets.h"

#include <meshoptimizer.h>

namespace volmark::mesh_isosurface {

namespace {

constexpr float kOverdrawThreshold = 1.05f; // how much worse for vertex caches less overdraw may be

void weld(const SurfaceMesh& mesh, OptimizedMesh& result) {
  std::vector<Vertex> all;
  all.reserve(mesh.positions.size());
  // Both zeros are one place.
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    all.push_back({mesh.positions[i] + 0.0f, mesh.normals[i] + 0.0f});
  const auto* indices = reinterpret_cast<const std::uint32_t*>(mesh.triangles.data());
  const std::size_t count = 3 * mesh.triangles.size();
  std::vector<unsigned> remap(all.size());
  const std::size_t kept =
      meshopt_generateVertexRemap(remap.data(), indices, count, all.data(), all.size(), sizeof(Vertex));
  result.vertices.resize(kept);
  meshopt_remapVertexBuffer(result.vertices.data(), all.data(), all.size(), sizeof(Vertex), remap.data());
  for (std::size_t i = 0; i < count; i += 3) {
    const std::uint32_t a = remap[indices[i]], b = remap[indices[i + 1]], c = remap[indices[i + 2]];
    if (a != b && b != c && c != a) result.indices.insert(result.indices.end(), {a, b, c});
  }
}

void cut(OptimizedMesh& mesh) {
  const std::size_t most = meshopt_buildMeshletsBound(mesh.indices.size(), kMeshletVertices, kMeshletTriangles);
  std::vector<meshopt_Meshlet> meshlets(most);
  std::vector<unsigned> vertices(most * kMeshletVertices);
  std::vector<unsigned char> triangles(most * kMeshletTriangles * 3);
  meshlets.resize(meshopt_buildMeshlets(meshlets.data(), vertices.data(), triangles.data(), mesh.indices.data(),
                                        mesh.indices.size(), &mesh.vertices[0].position.x, mesh.vertices.size(),
                                        sizeof(Vertex), kMeshletVertices, kMeshletTriangles, 0));
  for (const meshopt_Meshlet& meshlet : meshlets) {
    mesh.meshlets.push_back({.firstVertex = static_cast<uint>(mesh.meshletVertices.size()),
                             .firstTriangle = static_cast<uint>(mesh.meshletTriangles.size()),
                             .vertices = meshlet.vertex_count,
                             .triangles = meshlet.triangle_count});
    const unsigned* first = vertices.data() + meshlet.vertex_offset;
    mesh.meshletVertices.insert(mesh.meshletVertices.end(), first, first + meshlet.vertex_count);
    const unsigned char* corner = triangles.data() + meshlet.triangle_offset;
    for (unsigned i = 0; i < meshlet.triangle_count; ++i, corner += 3)
      mesh.meshletTriangles.push_back(corner[0] | unsigned(corner[1]) << 8 | unsigned(corner[2]) << 16);
  }
}

} // namespace

OptimizedMesh optimize(const SurfaceMesh& mesh, bool withMeshlets) {
  OptimizedMesh result;
  if (mesh.triangles.empty()) return result;
  weld(mesh, result);
  std::vector<std::uint32_t>& indices = result.indices;
  if (indices.empty()) return {};
  const std::size_t count = result.vertices.size();
  meshopt_optimizeVertexCache(indices.data(), indices.data(), indices.size(), count);
  meshopt_optimizeOverdraw(indices.data(), indices.data(), indices.size(), &result.vertices[0].position.x, count,
                           sizeof(Vertex), kOverdrawThreshold);
  const std::size_t used = meshopt_optimizeVertexFetch(result.vertices.data(), indices.data(), indices.size(),
                                                       result.vertices.data(), count, sizeof(Vertex));
  result.vertices.resize(used);
  if (withMeshlets) cut(result);
  return result;
}

} // namespace volmark::mesh_isosurface
