// Emission and absorption along a path, front to back, in parts: what every direct volume renderer shares. A technique
// decides which parts of a ray it visits, and calls accumulate() for them, front to back:
//   beginRay(); for each portion: beginPortion(), accumulateBeginning(), accumulate() ...; finishRay().
// Macros: PREINTEGRATED. LABELS_BINDING: the labels of segments are bound there, some may be hidden. BEYOND_BINDING: what
// clipping planes cut off is drawn, too, by the table bound there. SHADOWS_BINDING: samples look up the opacity shadow map
// bound there. SHADOW_MAP_BINDING: the rays are the light's, and write that map instead of a picture.
#ifndef PARTS_EMISSION_ABSORPTION_GLSL
#define PARTS_EMISSION_ABSORPTION_GLSL

#include <parts/march.glsl>
#ifdef SHADOWS_BINDING
#include <parts/shadows.glsl>
#endif
#include <volmark/transfer_function.glsl>

layout(constant_id = kIdEarlyTermination) const bool kEarlyTermination = true;

// Colour and opacity of one step (transfer_table.h).
#ifdef PREINTEGRATED
#define TABLE_SAMPLER sampler2D
#else
#define TABLE_SAMPLER sampler1D
#endif
layout(set = 0, binding = kBindingOwn) uniform TABLE_SAMPLER table;
#ifdef BEYOND_BINDING
layout(set = 0, binding = BEYOND_BINDING) uniform TABLE_SAMPLER tableBeyond;
#define LOOK_UP(by, coordinate) (by.beyond ? textureLod(tableBeyond, coordinate, 0.0) : textureLod(table, coordinate, 0.0))
#else
#define LOOK_UP(by, coordinate) textureLod(table, coordinate, 0.0)
#endif
#ifdef LABELS_BINDING
layout(set = 0, binding = LABELS_BINDING) uniform sampler3D labels;
#endif
#ifdef SHADOW_MAP_BINDING
layout(set = 0, binding = SHADOW_MAP_BINDING, rgba32f) uniform writeonly image2D shadowImage;
#endif

// Samples (or slabs) between two checks of the loop. Drivers that call functions to sample textures keep what is
// alive in memory around each call: four at a time share that, and the test for empty space.
const int kBlock = 4;

struct Accumulation {
  vec3 color;
  float transmittance;
  uint samples;
  uint visible; // of them, with opacity
  uint gradients;
#ifdef SHADOW_MAP_BINDING
  vec4 depths; // at which so much of the light is gone
  int known;   // of them
#endif
};

// Whether a place belongs to a hidden segment: that of the voxel nearest to it.
bool isHidden(VolumeGrid grid, Path path, float place) {
#ifdef LABELS_BINDING
  precise vec3 position = path.base + place * path.delta;
  vec3 voxel = floor(kShaderFiltering ? position + 0.5 : position * vec3(grid.dims));
  uint label = uint(round(255.0 * texelFetch(labels, clamp(ivec3(voxel), ivec3(0), grid.dims - 1), 0).r));
  return (march.hidden[label >> 5u] >> (label & 31u) & 1u) != 0u;
#else
  return false;
#endif
}

#ifdef SHADOW_MAP_BINDING

// The map's texels hold the distances from the light, in world units, at which a ray's transmittance falls to this.
float transmittanceOfDepth(int i) {
  return (float(kShadowDepths - i) - 0.5) / float(kShadowDepths);
}

// A ray ends when all is known that is to be known of it.
bool goesOn(float transmittance) {
  return transmittance > transmittanceOfDepth(kShadowDepths - 1);
}

// As below, of the opacity alone.
void addShown(VolumeGrid grid, Path path, vec4 sampled, float place, bool there, inout Accumulation sum) {
  bool counts = there && goesOn(sum.transmittance);
  if (kCounting && counts) {
    ++sum.samples;
    if (sampled.a > 0.0) ++sum.visible;
  }
  if (!counts || sampled.a <= 0.0) return;
  sum.transmittance -= sum.transmittance * sampled.a;
  while (sum.known < kShadowDepths && sum.transmittance <= transmittanceOfDepth(sum.known)) {
    sum.depths[sum.known] = path.entry + place * march.stepLength;
    ++sum.known;
  }
}

#else

bool goesOn(float transmittance) {
  return !kEarlyTermination || transmittance > march.endTransmittance;
}

// Adds what a sample at `place` (a slab from there on) contributes, if it is there and the ray has not ended.
void addShown(VolumeGrid grid, Path path, vec4 sampled, float place, bool there, inout Accumulation sum) {
  bool counts = there && goesOn(sum.transmittance);
  float weight = counts ? sum.transmittance * sampled.a : 0.0;
  if (kCounting && counts) {
    ++sum.samples;
    if (sampled.a > 0.0) ++sum.visible;
  }
  vec3 color = sampled.rgb;
  if (kShadingModel != kShadingNone && weight > 0.0) {
    vec3 world = worldAt(grid, path, place);
#ifdef SHADOWS_BINDING
    float arriving = shareThatArrives(world);
#else
    float arriving = 1.0;
#endif
    color = shadeOnPath(path, world, color, normalAt(grid, world), arriving);
    if (kCounting) ++sum.gradients;
  }
  sum.color += weight * color;
  sum.transmittance -= weight;
}

#endif

// The same, if it is of no hidden segment. A slab ends at `back`.
void add(VolumeGrid grid, Path path, vec4 sampled, float place, float back, bool there, inout Accumulation sum) {
  if (sampled.a > 0.0 && isHidden(grid, path, place)) sampled.a = 0.0;
#ifdef PREINTEGRATED
  if (sampled.a > 0.0 && isHidden(grid, path, back)) sampled.a = 0.0;
#endif
  addShown(grid, path, sampled, place, there, sum);
}

// What the transfer function says of texel values.
struct Classification {
  float scale;        // to table coordinates
  float bias;
  float visibleLow;   // texels at or below are transparent
  float visibleHigh;  // and those at or above
  bool beyond;        // of what clipping planes cut off
};

Classification classification(VolumeGrid grid, bool beyond) {
  return Classification(march.tableScale * grid.valueScale, march.tableScale * grid.valueBias + march.tableBias,
                        texelOf(grid, beyond ? march.visibleLowBeyond : march.visibleLow),
                        texelOf(grid, beyond ? march.visibleHighBeyond : march.visibleHigh), beyond);
}

// Rays and their parts.

ivec2 pictureSize() {
#ifdef SHADOW_MAP_BINDING
  return ivec2(march.shadowSize);
#else
  return frame.size;
#endif
}

Accumulation nothingYet() {
#ifdef SHADOW_MAP_BINDING
  return Accumulation(vec3(0), 1.0, 0u, 0u, 0u, vec4(infinity()), 0);
#else
  return Accumulation(vec3(0), 1.0, 0u, 0u, 0u);
#endif
}

// False if there is nothing to draw.
bool beginRay(VolumeGrid grid, ivec2 pixel, uint view, out Path path) {
  if (any(greaterThanEqual(pixel, pictureSize()))) return false;
#ifdef BEYOND_BINDING
  bool beyond = true;
#else
  bool beyond = false;
#endif
#ifdef SHADOW_MAP_BINDING
  vec2 tangents = ((vec2(pixel) + 0.5) / float(march.shadowSize) * 2.0 - 1.0) * march.shadowTangent;
  vec3 direction = march.shadowForward + tangents.x * march.shadowRight + tangents.y * march.shadowUp;
  Ray ray = Ray(frame.light.xyz, normalize(direction), 1.0);
  return makePath(grid, ray, 0.0, true, beyond, path);
#else
  return makePath(grid, pixelRay(pixel, view), pixelShift(pixel), true, beyond, path);
#endif
}

// Parts of a ray with one transfer function each: before, between and behind clipping planes.
#ifdef BEYOND_BINDING
const int kPortions = 3;
#else
const int kPortions = 1;
#endif

// Makes `path` portion n of itself.
Classification beginPortion(VolumeGrid grid, int n, inout Path path) {
#ifdef BEYOND_BINDING
  path.first = n == 0 ? 0.0 : n == 1 ? path.keptFirst : path.keptPlaces;
  path.places = n == 0 ? path.keptFirst : n == 1 ? path.keptPlaces : path.boxPlaces;
  return classification(grid, n != 1);
#else
  return classification(grid, false);
#endif
}

// True if there may be opacity between the lowest and the highest of some texel values.
bool visible(Classification by, float lowest, float highest) {
  return highest > by.visibleLow && lowest < by.visibleHigh;
}

// Sample i lies at place shift + i. The first one that is not clipped away, and the end of those before the exit; slab i
// goes from sample i to the next.
int firstSample(Path path) {
  return int(ceil(path.first - path.shift));
}
int sampleEnd(Path path) {
  return int(ceil(path.places - path.shift));
}

#ifndef PREINTEGRATED

// Straight colour and opacity of a sample. The sampler clamps.
vec4 classify(Classification by, float texel) {
  return LOOK_UP(by, by.scale * texel + by.bias);
}

// What lies before the first sample: nothing.
void accumulateBeginning(VolumeGrid grid, Path path, Classification by, inout Accumulation sum) {}

// Samples first <= i < end.
void accumulate(VolumeGrid grid, Path path, Classification by, int first, int end, inout Accumulation sum) {
  for (int i = first; i < end && goesOn(sum.transmittance); i += kBlock) {
    float place = path.shift + float(i);
    float a = texelAt(grid, path, place);
    float b = texelAt(grid, path, place + 1.0);
    float c = texelAt(grid, path, place + 2.0);
    float d = texelAt(grid, path, place + 3.0);
    if (visible(by, min(min(a, b), min(c, d)), max(max(a, b), max(c, d)))) {
      vec4 sampleA = classify(by, a);
      vec4 sampleB = classify(by, b);
      vec4 sampleC = classify(by, c);
      vec4 sampleD = classify(by, d);
      add(grid, path, sampleA, place, place, true, sum);
      add(grid, path, sampleB, place + 1.0, place, i + 1 < end, sum);
      add(grid, path, sampleC, place + 2.0, place, i + 2 < end, sum);
      add(grid, path, sampleD, place + 3.0, place, i + 3 < end, sum);
    } else if (kCounting) {
      sum.samples += uint(min(kBlock, end - i));
    }
  }
}

#else

// Straight colour and opacity of a slab; colours are interpolated premultiplied.
vec4 classify(Classification by, float front, float back) {
  vec4 slab = LOOK_UP(by, by.scale * vec2(front, back) + by.bias);
  return vec4(slab.rgb / max(slab.a, 1e-30), slab.a);
}

// A slab of which only `share` of the length is there. Straight colours keep when the opacity changes. Below the
// largest float under 1 the power is defined.
vec4 cutSlab(vec4 slab, float share) {
  return vec4(slab.rgb, opacityOfStep(min(slab.a, 0.99999994), share));
}

// The part of a slab before the first sample, where a clipping plane or the jitter cuts it.
void accumulateBeginning(VolumeGrid grid, Path path, Classification by, inout Accumulation sum) {
  float place = min(path.shift + float(firstSample(path)), path.places);
  float share = place - path.first;
  if (share <= 0.0) return;
  float front = texelAt(grid, path, path.first);
  float back = texelAt(grid, path, place);
  if (kCounting) ++sum.samples;
  add(grid, path, cutSlab(classify(by, front, back), share), path.first, place, true, sum);
}

// Slabs first <= i < end (Engel, Kraus, Ertl 2001), the last one of the ray up to the exit. The sample at the back of one
// slab is the front of the next.
void accumulate(VolumeGrid grid, Path path, Classification by, int first, int end, inout Accumulation sum) {
  if (first >= end || !goesOn(sum.transmittance)) return;
  float front = texelAt(grid, path, path.shift + float(first));
  if (kCounting) ++sum.samples;
  for (int i = first; i < end && goesOn(sum.transmittance); i += kBlock) {
    float place = path.shift + float(i);
    float a = texelAt(grid, path, min(place + 1.0, path.places));
    float b = texelAt(grid, path, min(place + 2.0, path.places));
    float c = texelAt(grid, path, min(place + 3.0, path.places));
    float d = texelAt(grid, path, min(place + 4.0, path.places));
    if (visible(by, min(min(min(a, b), min(c, d)), front), max(max(max(a, b), max(c, d)), front))) {
      vec4 slabA = classify(by, front, a);
      vec4 slabB = classify(by, a, b);
      vec4 slabC = classify(by, b, c);
      vec4 slabD = classify(by, c, d);
      float rest = path.places - place;
      if (rest < float(kBlock)) {
        slabA = cutSlab(slabA, clamp(rest, 0.0, 1.0));
        slabB = cutSlab(slabB, clamp(rest - 1.0, 0.0, 1.0));
        slabC = cutSlab(slabC, clamp(rest - 2.0, 0.0, 1.0));
        slabD = cutSlab(slabD, clamp(rest - 3.0, 0.0, 1.0));
      }
      add(grid, path, slabA, place, min(place + 1.0, path.places), true, sum);
      add(grid, path, slabB, place + 1.0, min(place + 2.0, path.places), i + 1 < end, sum);
      add(grid, path, slabC, place + 2.0, min(place + 3.0, path.places), i + 2 < end, sum);
      add(grid, path, slabD, place + 3.0, min(place + 4.0, path.places), i + 3 < end, sum);
    } else if (kCounting) {
      sum.samples += uint(min(kBlock, end - i));
    }
    front = d;
  }
}

#endif

// Writes and counts what has been gathered; every invocation of the workgroup calls it. `nodes`: questions asked of a
// structure, which count as steps of the ray.
void finishRay(ivec2 pixel, uint view, bool entered, Accumulation sum, uint nodes) {
  bool inPicture = all(lessThan(pixel, pictureSize()));
#ifdef SHADOW_MAP_BINDING
  if (inPicture) imageStore(shadowImage, pixel, sum.depths);
  if (kCounting) addToCounterBySubgroup(kCounterShadowSamples, sum.samples);
  if (kCounting) addToCounterBySubgroup(kCounterShadowNodes, nodes);
#else
  if (inPicture)
    writePixel(pixel, view, vec4(sum.color, 1.0 - sum.transmittance), infinity(), sum.samples + nodes);
  countRay(sum.samples, entered, entered && !goesOn(sum.transmittance), sum.gradients);
  if (kCounting) addToCounterBySubgroup(kCounterVisible, sum.visible);
  if (kCounting) addToCounterBySubgroup(kCounterNodes, nodes);
#endif
}

#endif
