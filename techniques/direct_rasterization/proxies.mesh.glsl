// Proxies of occupied regions: for each view a quad in screen space over the projected corners, as near as the nearest one
// (Kreskowski et al. 2022, section 3.5.2).
// Macro: VIEWS, of the picture. Clipping planes need no heed: a proxy larger than what they leave is still conservative.
// One invocation is one region; a workgroup has 32. proxies.frag.glsl runs next.
#version 460

#extension GL_EXT_mesh_shader : require

#include <direct_rasterization/blocks.glsl>
#include <direct_rasterization/region_box.glsl>

layout(local_size_x = kTaskThreads) in;
layout(triangles, max_vertices = 4 * kTaskThreads * VIEWS, max_primitives = 2 * kTaskThreads * VIEWS) out;

layout(set = 0, binding = kBindingCounts, scalar) readonly buffer CountsBlock {
  uint counts[];
};
layout(set = 0, binding = kBindingList, scalar) readonly buffer ListBlock {
  uint list[];
};
layout(push_constant, scalar) uniform DrawPush {
  DrawConstants draw;
};

out gl_MeshPerVertexEXT {
  vec4 gl_Position;
} gl_MeshVerticesEXT[];
perprimitiveEXT out gl_MeshPerPrimitiveEXT {
  perprimitiveEXT int gl_Layer;
} gl_MeshPrimitivesEXT[];
layout(location = 0) out flat uint regionOutput[];

// Low and high corner in normalised device coordinates, grown, and the depth of the nearest corner; empty if all of it is
// behind the eye.
void project(ivec3 region, ViewConstants view, out vec4 box, out float depth) {
  box = vec4(3.402823466e38, 3.402823466e38, -3.402823466e38, -3.402823466e38);
  float nearest = 3.402823466e38;
  for (int corner = 0; corner < 8; ++corner) {
    vec4 clip = clipPosition(view, regionCorner(region, corner), surface.near);
    if (clip.w <= 0.0) {
      // No region is partly behind: all of this one is.
      box = vec4(2.0, 2.0, 2.0, 2.0);
      depth = 0.0;
      return;
    }
    vec2 place = clip.xy / clip.w;
    box = vec4(min(box.xy, place), max(box.zw, place));
    nearest = min(nearest, clip.w);
  }
  vec2 grow = 2.0 * grid.grow / vec2(frame.size);
  box = clamp(box + vec4(-grow, grow), -2.0, 2.0);
  // A little nearer than any rounding makes a fragment of the surface: of places in the world, and of depth.
  nearest = max(nearest - 1e-6 * distance(frame.boxMinimum, frame.boxMaximum), surface.near);
  depth = min(surface.near / nearest * (1.0 + 1e-5), 1.0);
}

void main() {
  uint total = counts[draw.totalIndex];
  uint first = draw.first + uint(kTaskThreads) * workgroupIndex(gl_WorkGroupID);
  uint regions = first < total ? min(total - first, uint(kTaskThreads)) : 0u;
  SetMeshOutputsEXT(4u * regions * VIEWS, 2u * regions * VIEWS);
  uint lane = gl_LocalInvocationIndex;
  if (lane >= regions) return;
  uint region = list[first + lane];
  ivec3 place = placeOf(region, grid.regions);
  for (uint view = 0u; view < VIEWS; ++view) {
    vec4 box;
    float depth;
    project(place, frame.views[view], box, depth);
    uint quad = view * regions + lane;
    for (uint corner = 0u; corner < 4u; ++corner) {
      vec2 at = vec2((corner & 1u) == 0u ? box.x : box.z, corner < 2u ? box.y : box.w);
      gl_MeshVerticesEXT[4u * quad + corner].gl_Position = vec4(at, depth, 1.0);
      regionOutput[4u * quad + corner] = region;
    }
    gl_PrimitiveTriangleIndicesEXT[2u * quad] = 4u * quad + uvec3(0, 1, 2);
    gl_PrimitiveTriangleIndicesEXT[2u * quad + 1u] = 4u * quad + uvec3(2, 1, 3);
    gl_MeshPrimitivesEXT[2u * quad].gl_Layer = layerOf(view);
    gl_MeshPrimitivesEXT[2u * quad + 1u].gl_Layer = layerOf(view);
  }
}
