// Samples and gradients of the volume texture (gpu/volume_texture.h).
// `shaderFiltering` is meant to be a specialisation constant of the technique: true interpolates eight
// texelFetch in 32-bit floats, false uses the sampler's linear filter (whose weights may have 8 bits).
#ifndef VOLMARK_VOLUME_GLSL
#define VOLMARK_VOLUME_GLSL

#include <volmark/frame.glsl>

// What sampling needs to know; make it once per invocation.
struct VolumeGrid {
  vec3 boxMinimum;      // of voxel centres, world
  vec3 boxMaximum;
  vec3 spacing;
  vec3 voxelsPerUnit;   // 1 / spacing
  ivec3 dims;
  float valueScale;     // sampled texel to normalised scalar
  float valueBias;
};

VolumeGrid volumeGrid(FrameConstants constants) {
  return VolumeGrid(constants.boxMinimum, constants.boxMaximum, constants.spacing, 1.0 / constants.spacing,
                    constants.dims, constants.valueScale, constants.valueBias);
}

// Continuous voxel coordinates, [0, dims-1] inside the box.
vec3 toVoxel(VolumeGrid grid, vec3 world) {
  return (world - grid.boxMinimum) * grid.voxelsPerUnit;
}

vec3 toWorld(VolumeGrid grid, vec3 voxel) {
  return grid.boxMinimum + voxel * grid.spacing;
}

// Texture coordinates; voxel centres lie at (i + 0.5) / dims.
vec3 toTexture(VolumeGrid grid, vec3 world) {
  return (toVoxel(grid, world) + 0.5) / vec3(grid.dims);
}

// Normalised and clamped scalar of a texel value; after interpolation, never before.
float toScalar(VolumeGrid grid, float texel) {
  return clamp(grid.valueScale * texel + grid.valueBias, 0.0, 1.0);
}

// Normalised scalar of one voxel; the index must be inside.
float voxelValue(sampler3D volume, VolumeGrid grid, ivec3 voxel) {
  return toScalar(grid, texelFetch(volume, voxel, 0).r);
}

// Texel values of the eight corners of the cell whose lowest corner is `voxel`: low has z, high has z + 1, the
// components are (x, y), (x+1, y), (x, y+1), (x+1, y+1). Indices beyond the volume are clamped.
void fetchCell(sampler3D volume, VolumeGrid grid, ivec3 voxel, out vec4 low, out vec4 high) {
  ivec3 a = clamp(voxel, ivec3(0), grid.dims - 1);
  ivec3 b = clamp(voxel + 1, ivec3(0), grid.dims - 1);
  low = vec4(texelFetch(volume, a, 0).r, texelFetch(volume, ivec3(b.x, a.y, a.z), 0).r,
             texelFetch(volume, ivec3(a.x, b.y, a.z), 0).r, texelFetch(volume, ivec3(b.x, b.y, a.z), 0).r);
  high = vec4(texelFetch(volume, ivec3(a.x, a.y, b.z), 0).r, texelFetch(volume, ivec3(b.x, a.y, b.z), 0).r,
              texelFetch(volume, ivec3(a.x, b.y, b.z), 0).r, texelFetch(volume, b, 0).r);
}

// Trilinear interpolation inside a cell; `fraction` in [0,1].
float interpolateCell(vec4 low, vec4 high, vec3 fraction) {
  vec4 plane = mix(low, high, fraction.z);
  vec2 line = mix(plane.xy, plane.zw, fraction.y);
  return mix(line.x, line.y, fraction.x);
}

// Normalised, clamped scalar at a point; points outside the box give the value at the nearest side.
float sampleVolume(sampler3D volume, VolumeGrid grid, vec3 world, bool shaderFiltering) {
  if (!shaderFiltering) return toScalar(grid, textureLod(volume, toTexture(grid, world), 0.0).r);
  vec3 voxel = clamp(toVoxel(grid, world), vec3(0), vec3(grid.dims - 1));
  vec3 corner = floor(voxel);
  vec4 low, high;
  fetchCell(volume, grid, ivec3(corner), low, high);
  return toScalar(grid, interpolateCell(low, high, voxel - corner));
}

// Central difference along one axis; 0 along an axis of one voxel.
float differenceAlong(sampler3D volume, VolumeGrid grid, vec3 world, vec3 offset, bool shaderFiltering) {
  vec3 ahead = clamp(world + offset, grid.boxMinimum, grid.boxMaximum);
  vec3 behind = clamp(world - offset, grid.boxMinimum, grid.boxMaximum);
  float span = dot(ahead - behind, sign(offset));
  if (span <= 0.0) return 0.0;
  return (sampleVolume(volume, grid, ahead, shaderFiltering) - sampleVolume(volume, grid, behind, shaderFiltering)) /
         span;
}

// Gradient of the normalised, clamped field per world unit (harness/README.md, Conventions). `world` must lie
// in the box.
vec3 sampleGradient(sampler3D volume, VolumeGrid grid, vec3 world, bool shaderFiltering) {
  return vec3(differenceAlong(volume, grid, world, vec3(grid.spacing.x, 0, 0), shaderFiltering),
              differenceAlong(volume, grid, world, vec3(0, grid.spacing.y, 0), shaderFiltering),
              differenceAlong(volume, grid, world, vec3(0, 0, grid.spacing.z), shaderFiltering));
}

#endif
