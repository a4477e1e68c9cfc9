#include "surface/write_mesh.h"
#include "volmark/error.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace volmark {
namespace {

class WriteMesh : public testing::Test {
protected:
  void SetUp() override {
    m_folder = std::filesystem::path(testing::TempDir()) / "write_mesh";
    std::filesystem::remove_all(m_folder);
    std::filesystem::create_directories(m_folder);
  }
  std::filesystem::path path(const char* name) const { return m_folder / name; }
  std::string text(const char* name) const {
    std::ifstream file(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  const SurfaceMesh m_mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, -3}},
                           .normals = {{0, 0, 1}, {1, 0, 0}, {0, 0, 0}, {0, -1, 0}},
                           .triangles = {{0, 1, 2}, {0, 3, 1}}};

private:
  std::filesystem::path m_folder;
};

template <class Value> Value at(const std::string& bytes, std::size_t offset) {
  Value value;
  std::memcpy(&value, bytes.data() + offset, sizeof(value));
  return value;
}

TEST_F(WriteMesh, PlyHoldsVerticesAndFaces) {
  writeMesh(path("a.ply"), m_mesh, "made here");
  const std::string bytes = text("a.ply");
  const std::string end = "end_header\n";
  const std::size_t data = bytes.find(end) + end.size();
  EXPECT_THAT(bytes.substr(0, data), testing::StartsWith("ply\nformat binary_little_endian 1.0\ncomment made here\n"
                                                         "element vertex 4\n"));
  EXPECT_THAT(bytes.substr(0, data), testing::HasSubstr("element face 2\nproperty list uchar int vertex_indices\n"));
  ASSERT_EQ(bytes.size(), data + 4 * 24 + 2 * 13);
  EXPECT_EQ(at<glm::vec3>(bytes, data + 3 * 24), m_mesh.positions[3]);
  EXPECT_EQ(at<glm::vec3>(bytes, data + 3 * 24 + 12), m_mesh.normals[3]);
  EXPECT_EQ(bytes[data + 4 * 24 + 13], 3);
  EXPECT_EQ(at<glm::uvec3>(bytes, data + 4 * 24 + 14), m_mesh.triangles[1]);
}

TEST_F(WriteMesh, GltfDescribesItsBuffer) {
  writeMesh(path("a.glb"), m_mesh, "made here");
  const std::string bytes = text("a.glb");
  ASSERT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(at<std::uint32_t>(bytes, 4), 2u);
  EXPECT_EQ(at<std::uint32_t>(bytes, 8), bytes.size());
  const auto jsonBytes = at<std::uint32_t>(bytes, 12);
  ASSERT_EQ(bytes.substr(16, 4), "JSON");
  EXPECT_EQ(jsonBytes % 4, 0u);
  const auto json = nlohmann::json::parse(bytes.substr(20, jsonBytes));
  const std::size_t binary = 20 + jsonBytes + 8;
  EXPECT_EQ(bytes.substr(binary - 4, 4), std::string("BIN\0", 4));
  EXPECT_EQ(json["buffers"][0]["byteLength"], bytes.size() - binary);
  EXPECT_EQ(json["accessors"][0]["min"], nlohmann::json({0.0, 0.0, -3.0}));
  EXPECT_EQ(json["accessors"][0]["max"], nlohmann::json({1.0, 2.0, 0.0}));
  const auto offsetOf = [&](int accessor) {
    return binary +
           json["bufferViews"][json["accessors"][accessor]["bufferView"].get<int>()]["byteOffset"].get<std::size_t>();
  };
  const auto& attributes = json["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_EQ(at<glm::vec3>(bytes, offsetOf(attributes["POSITION"]) + 24), m_mesh.positions[2]);
  EXPECT_EQ(at<glm::vec3>(bytes, offsetOf(attributes["NORMAL"]) + 24), glm::vec3(0, 0, 1)); // there was none
  EXPECT_EQ(at<glm::uvec3>(bytes, offsetOf(json["meshes"][0]["primitives"][0]["indices"]) + 12), m_mesh.triangles[1]);
}

TEST_F(WriteMesh, RefusesWhatItCannotWriteAndLeavesNothing) {
  EXPECT_THROW(writeMesh(path("a.obj"), m_mesh, ""), InputError);
  EXPECT_THROW(writeMesh(path("a.ply"), {}, ""), InputError);
  EXPECT_THROW(writeMesh(path("no/such/folder/a.ply"), m_mesh, ""), std::exception);
  EXPECT_TRUE(std::filesystem::is_empty(path("")));
}

} // namespace
} // namespace volmark
