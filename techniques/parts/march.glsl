// The ray of one invocation and the samples along it, for all ray marchers.
// Macro: FRAGMENT, in fragment shaders.
#ifndef PARTS_MARCH_GLSL
#define PARTS_MARCH_GLSL

#include <parts/shared.h>
#include <volmark/box.glsl>
#include <volmark/counters.glsl>
#include <volmark/frame.glsl>
#include <volmark/random.glsl>
#include <volmark/shading.glsl>
#include <volmark/view.glsl>
#include <volmark/volume.glsl>

#ifndef FRAGMENT
layout(local_size_x = kGroupSize, local_size_y = kGroupSize) in;
#endif

layout(constant_id = kIdShaderFiltering) const bool kShaderFiltering = false;
layout(constant_id = kIdShadingModel) const uint kShadingModel = 0u;
layout(constant_id = kIdJitter) const bool kJitter = false;
layout(constant_id = kIdCounting) const bool kCounting = false;

VOLMARK_FRAME(kBindingFrame)
layout(set = 0, binding = kBindingVolume) uniform sampler3D volume;
#ifdef FRAGMENT
layout(location = 0) out vec4 colorOutput;
layout(location = 1) out float distanceOutput;
#else
layout(set = 0, binding = kBindingColor, rgba16f) uniform writeonly image2DArray colorImage;
layout(set = 0, binding = kBindingDistance, r32f) uniform writeonly image2DArray distanceImage;
#endif
VOLMARK_COUNTERS(kBindingCounters)
layout(set = 0, binding = kBindingSteps, r32f) uniform writeonly image2DArray stepsImage;
layout(push_constant, scalar) uniform MarchBlock {
  MarchConstants march;
};

// A ray cut to the volume. Places on it are counted in steps from the entry: place f lies at ray parameter
// entry + f * stepLength, and at `base + f * delta` in the space that the volume is sampled in, so that no
// rounding adds up along the ray.
struct Path {
  Ray ray;
  float entry;          // ray parameter of place 0, world units
  float first;          // place where the part to be drawn begins
  float places;         // and ends, in steps; not an integer in general
  float keptFirst;      // volumes: the part that clipping planes keep, and the exit from the box
  float keptPlaces;
  float boxPlaces;
  vec3 entryNormal;
  vec3 base;            // texture coordinates, or voxel coordinates where the shader filters
  vec3 delta;
  float shift;          // jitter in steps, [0,1); 0 without
};

// Jittering (Nysjö, Malmberg, Nyström 2019, section 4: "stochastic jittering") shifts all samples of a ray. Both eyes get
// the same shift in a pixel.
float jitterOf(ivec2 pixel) {
  uint index = uint(pixel.y * frame.size.x + pixel.x);
  return toUnitFloat(randomBits(frame.seed, index, frame.frameIndex, 0u));
}

// False if the ray misses the volume or all of it is clipped away; with `beyond`, that is kept apart. Place 0 is where the
// ray enters the box if `fromBox`, so that clipping planes move no sample, else where they leave it.
bool makePath(VolumeGrid grid, Ray ray, float shift, bool fromBox, bool beyond, out Path path) {
  path.ray = ray;
  RayInterval interval = wholeRay(path.ray);
  cutByBox(path.ray, grid.boxMinimum, grid.boxMaximum, interval);
  path.entry = interval.entry;
  float boxExit = interval.exit;
  cutByClippingPlanes(frame, path.ray, interval);
  if (interval.entry > interval.exit) {
    if (!beyond || path.entry > boxExit) return false;
    interval.entry = interval.exit = boxExit;
  }
  if (!fromBox) path.entry = interval.entry;
  path.entryNormal = interval.normal;
  path.first = (interval.entry - path.entry) / march.stepLength;
  path.places = (interval.exit - path.entry) / march.stepLength;
  path.keptFirst = path.first;
  path.keptPlaces = path.places;
  path.boxPlaces = (boxExit - path.entry) / march.stepLength;
  vec3 unit = kShaderFiltering ? vec3(1) : 1.0 / vec3(grid.dims);
  vec3 toUnit = grid.voxelsPerUnit * unit;
  path.base = (pointOnRay(path.ray, path.entry) - grid.boxMinimum) * toUnit + (kShaderFiltering ? vec3(0) : 0.5 * unit);
  path.delta = path.ray.direction * march.stepLength * toUnit;
  path.shift = shift;
  return true;
}

// The ray of a pixel, and the shift of its samples.
Ray pixelRay(ivec2 pixel, uint view) {
  return rayThroughPixel(frame.views[view], pixel, frame.size);
}
float pixelShift(ivec2 pixel) {
  return kJitter ? jitterOf(pixel) : 0.0;
}

// The volume's texel value at a place. Neither normalised nor clamped: it is compared with texelOf() a scalar,
// so that a sample costs nothing but the fetch.
float texelAt(VolumeGrid grid, Path path, float place) {
  precise vec3 position = path.base + place * path.delta; // the same bits in every shader
  if (!kShaderFiltering) return textureLod(volume, position, 0.0).r;
  vec3 voxel = clamp(position, vec3(0), vec3(grid.dims - 1));
  vec3 corner = floor(voxel);
  vec4 low, high;
  fetchCell(volume, grid, ivec3(corner), low, high);
  return interpolateCell(low, high, voxel - corner);
}

// The texel value of a normalised scalar.
float texelOf(VolumeGrid grid, float scalar) {
  return (scalar - grid.valueBias) / grid.valueScale;
}

vec3 worldAt(VolumeGrid grid, Path path, float place) {
  vec3 world = pointOnRay(path.ray, path.entry + place * march.stepLength);
  return clamp(world, grid.boxMinimum, grid.boxMaximum);
}

// Unit normal towards lower values, or zero where the field has no gradient.
vec3 normalAt(VolumeGrid grid, vec3 world) {
  return normalOfGradient(sampleGradient(volume, grid, world, kShaderFiltering));
}

// `arriving`: share of the light that nothing keeps from `world`.
vec3 shadeOnPath(Path path, vec3 world, vec3 color, vec3 normal, float arriving) {
  vec3 toEye = -path.ray.direction;
  vec3 toLight = towardsLight(frame, world, toEye);
  return shade(kShadingModel, color, normal, toLight, toEye, arriving * frame.lightColor, frame.ambient);
}

// The distance of a pixel without a surface.
float infinity() {
  return uintBitsToFloat(0x7f800000u);
}

// Where a pixel of a view lies in the output images.
ivec3 texelIn(ivec2 pixel, uint view) {
  return ivec3(pixel, int(bitfieldExtract(march.layers, int(8u * view), 8)));
}

// `distance` along the view direction, +infinity if there is no surface. `samples` are for counting frames.
void writePixel(ivec2 pixel, uint view, vec4 color, float distance, uint samples) {
#ifdef FRAGMENT
  colorOutput = color;
  distanceOutput = distance;
#else
  imageStore(colorImage, texelIn(pixel, view), color);
  imageStore(distanceImage, texelIn(pixel, view), vec4(distance));
#endif
  if (kCounting) imageStore(stepsImage, texelIn(pixel, view), vec4(samples));
}

// All invocations name the same counter. Helper invocations of fragment shaders may take part in what a subgroup does; what
// they add alone is dropped.
void countUp(uint counter, uint amount) {
#ifdef FRAGMENT
  addToCounter(counter, amount);
#else
  addToCounterBySubgroup(counter, amount);
#endif
}

// Adds the work of one ray; every invocation calls it, with zeros if its ray misses.
void countRay(uint samples, bool entered, bool ended, uint gradients) {
  if (!kCounting) return;
  countUp(kCounterSamples, samples);
  countUp(kCounterRays, entered ? 1u : 0u);
  countUp(kCounterEnded, ended ? 1u : 0u);
  countUp(kCounterGradients, gradients);
}

#endif
