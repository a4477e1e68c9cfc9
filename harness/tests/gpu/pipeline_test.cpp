#include "gpu_test.h"
#include "volmark/error.h"
#include "volmark/gpu/rendering.h"
#include "volmark/gpu/target.h"

#include <array>

namespace volmark::gpu::test {

namespace {

using glm::vec4;

constexpr int kSide = 8;

class PipelineTest : public GpuTest {
protected:
  /// Draws into view 0 of a target cleared to `clear` and returns the picture.
  template <class Record>
  Picture draw(const Target& target, const vec4& clear, Record record, std::uint32_t viewMask = 0) {
    Commands commands(device());
    commands.begin();
    target.initialise(commands);
    {
      const Rendering rendering(commands, {.size = {kSide, kSide},
                                           .layers = static_cast<std::uint32_t>(target.views),
                                           .viewMask = viewMask,
                                           .colors = {{.view = target.color.view(), .clear = true, .value = clear}}});
      record(commands);
    }
    commands.submit();
    commands.wait();
    return readBack(device(), target, 0);
  }
};

constexpr const char* kCover = "#version 460\n"
                               "void main() {\n"
                               "  vec2 corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1);\n"
                               "  gl_Position = vec4(4.0 * corner - 1.0, 0.0, 1.0);\n"
                               "}\n";
constexpr const char* kColor = "#version 460\n"
                               "layout(push_constant) uniform Push { vec4 color; };\n"
                               "layout(location = 0) out vec4 result;\n"
                               "void main() { result = color; }\n";

GraphicsPipelineDescription coverDescription() {
  GraphicsPipelineDescription description;
  description.name = "cover";
  description.shaders = {{addShader("cover.vert.glsl", kCover), VK_SHADER_STAGE_VERTEX_BIT},
                         {addShader("color.frag.glsl", kColor), VK_SHADER_STAGE_FRAGMENT_BIT}};
  description.layout.pushConstantBytes = sizeof(vec4);
  description.colorFormats = {kColorFormat};
  return description;
}

} // namespace

TEST_F(PipelineTest, SpecialisationReachesTheShader) {
  const auto found = evaluate<vec4>("vec4", 1,
                                    "layout(constant_id = 5) const float a = 0;\n"
                                    "layout(constant_id = 2) const bool b = false;\n"
                                    "layout(constant_id = 9) const int c = 0;\n"
                                    "layout(constant_id = 1) const uint d = 0u;",
                                    "result[i] = vec4(a, b ? 1 : 0, c, d);", {}, {},
                                    Specialisation().set(2, true).set(5, 0.25f).set(9, -7).set(1, 11u));
  EXPECT_EQ(found[0], vec4(0.25f, 1, -7, 11));
}

TEST_F(PipelineTest, BlendsPremultipliedColours) {
  const vec4 behind(0.25f, 0.5f, 0, 0.5f), front(0.5f, 0, 0.25f, 0.5f);
  for (const Blending blending : {Blending::none, Blending::premultiplied}) {
    GraphicsPipelineDescription description = coverDescription();
    description.blending = blending;
    const Pipeline pipeline(device(), description);
    const Target target(device(), kSide, kSide, 1);
    const Picture picture = draw(target, behind, [&](Commands& commands) {
      commands.bind(pipeline, {}, bytesOf(front));
      vkCmdDraw(commands.handle(), 3, 1, 0, 0);
    });
    const vec4 expected = blending == Blending::none ? front : front + (1 - front.a) * behind;
    for (const vec4& color : picture.color)
      ASSERT_EQ(color, expected);
  }
}

TEST_F(PipelineTest, DrawsBothViewsByMultiview) {
  if (!device().facts().multiview) GTEST_SKIP() << "no multiview";
  GraphicsPipelineDescription description = coverDescription();
  description.viewMask = 3;
  description.shaders[1].path =
      addShader("view_index.frag.glsl", "#version 460\n#extension GL_EXT_multiview : require\n"
                                        "layout(push_constant) uniform Push { vec4 color; };\n"
                                        "layout(location = 0) out vec4 result;\n"
                                        "void main() { result = color + float(gl_ViewIndex); }\n");
  const Pipeline pipeline(device(), description);
  const Target target(device(), kSide, kSide, 2);
  draw(
      target, vec4(0),
      [&](Commands& commands) {
        commands.bind(pipeline, {}, bytesOf(vec4(1, 2, 3, 4)));
        vkCmdDraw(commands.handle(), 3, 1, 0, 0);
      },
      3);
  for (int view = 0; view < 2; ++view)
    for (const vec4& color : readBack(device(), target, view).color)
      ASSERT_EQ(color, vec4(1, 2, 3, 4) + static_cast<float>(view));
}

TEST_F(PipelineTest, DrawsMeshletsToLayers) {
  if (!device().facts().meshShader) GTEST_SKIP() << "no mesh shaders";
  // Only the members in use are redeclared: glslang would ask for more capabilities otherwise.
  GraphicsPipelineDescription description = coverDescription();
  description.shaders[0] = {
      addShader("cover.mesh.glsl",
                "#version 460\n#extension GL_EXT_mesh_shader : require\n"
                "layout(local_size_x = 1) in;\n"
                "layout(triangles, max_vertices = 3, max_primitives = 1) out;\n"
                "perprimitiveEXT out gl_MeshPerPrimitiveEXT { perprimitiveEXT int gl_Layer; } gl_MeshPrimitivesEXT[];\n"
                "void main() {\n"
                "  SetMeshOutputsEXT(3, 1);\n"
                "  for (int i = 0; i < 3; ++i)\n"
                "    gl_MeshVerticesEXT[i].gl_Position = vec4(4.0 * vec2(i & 1, i >> 1) - 1.0, 0.0, 1.0);\n"
                "  gl_PrimitiveTriangleIndicesEXT[0] = uvec3(0, 1, 2);\n"
                "  gl_MeshPrimitivesEXT[0].gl_Layer = int(gl_WorkGroupID.x);\n"
                "}\n"),
      VK_SHADER_STAGE_MESH_BIT_EXT};
  const Pipeline pipeline(device(), description);
  const Target target(device(), kSide, kSide, 2);
  draw(target, vec4(0), [&](Commands& commands) {
    commands.bind(pipeline, {}, bytesOf(vec4(0.5f)));
    device().cmdDrawMeshTasks(commands.handle(), 2, 1, 1);
  });
  for (int view = 0; view < 2; ++view)
    for (const vec4& color : readBack(device(), target, view).color)
      ASSERT_EQ(color, vec4(0.5f));
}

TEST_F(PipelineTest, SubgroupSizesBeyondTheDeviceAreUnsupported) {
  ComputePipelineDescription description;
  description.name = "subgroups";
  description.shader = {
      addShader("subgroups.comp.glsl", "#version 460\nlayout(local_size_x = 128) in;\nvoid main() {}\n")};
  description.requiredSubgroupSize = 2 * device().facts().maximumSubgroupSize;
  EXPECT_THROW(Pipeline(device(), description), UnsupportedError);
  if (!device().facts().subgroupSizeControl) return;
  description.requiredSubgroupSize = device().facts().maximumSubgroupSize;
  EXPECT_NO_THROW(Pipeline(device(), description));
}

TEST_F(PipelineTest, ShadersWithErrorsAreRefused) {
  const ComputePipelineDescription description{"broken", {addShader("refused.comp.glsl", "#version 460\nnonsense\n")}};
  EXPECT_THROW(Pipeline(device(), description), InputError);
}

} // namespace volmark::gpu::test
