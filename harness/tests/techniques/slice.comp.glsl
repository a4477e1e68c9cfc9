// Shows the middle z slice of the resident time step. One invocation is one pixel of one view. Nothing runs
// after it.
#version 460
#include <volmark/volume.glsl>

VOLMARK_FRAME(0)
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 1) uniform sampler3D volume;
layout(set = 0, binding = 2, rgba16f) uniform writeonly image2DArray color;
layout(set = 0, binding = 3, r32f) uniform writeonly image2DArray distanceImage;

void main() {
  ivec3 pixel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(pixel.xy, frame.size))) return;
  VolumeGrid grid = volumeGrid(frame);
  vec2 place = (vec2(pixel.xy) + 0.5) / vec2(frame.size);
  ivec3 voxel = ivec3(ivec2(place * vec2(grid.dims.xy)), grid.dims.z / 2);
  imageStore(color, pixel, vec4(vec3(voxelValue(volume, grid, voxel)), 1.0));
  imageStore(distanceImage, pixel, vec4(1.0 / 0.0));
}
