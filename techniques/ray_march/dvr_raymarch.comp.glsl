// Emission and absorption, front to back, without acceleration: the "None" column of Faludi et al. 2021,
// Table 1, with its transfer function as a 1-D or a 2-D pre-integrated table (section 3.2).
// One invocation is one pixel of one view (z); a workgroup is 8 x 8 pixels. Nothing runs after it.
#version 460

#include <ray_march/march.glsl>
#include <volmark/transfer_function.glsl>

layout(constant_id = kIdEarlyTermination) const bool kEarlyTermination = true;

// Colour and opacity of one step (transfer_table.h). The macro PREINTEGRATED changes the table's type.
#ifdef PREINTEGRATED
layout(set = 0, binding = kBindingOwn) uniform sampler2D table;
#else
layout(set = 0, binding = kBindingOwn) uniform sampler1D table;
#endif

// Samples (or slabs) between two checks of the loop. Drivers that call functions to sample textures keep what is
// alive in memory around each call: four at a time share that, and the test for empty space.
const int kBlock = 4;

struct Accumulation {
  vec3 color;
  float transmittance;
  uint samples;
  uint gradients;
};

bool goesOn(float transmittance) {
  return !kEarlyTermination || transmittance > march.endTransmittance;
}

// Adds what a sample at `place` (a slab from there on) contributes, if it is there and the ray has not ended.
void add(VolumeGrid grid, Path path, vec4 sampled, float place, bool there, inout Accumulation sum) {
  bool counts = there && goesOn(sum.transmittance);
  float weight = counts ? sum.transmittance * sampled.a : 0.0;
  if (kCounting && counts) ++sum.samples;
  vec3 color = sampled.rgb;
  if (kShadingModel != kShadingNone && weight > 0.0) {
    color = shadeOnPath(path, color, normalAt(grid, path, place));
    if (kCounting) ++sum.gradients;
  }
  sum.color += weight * color;
  sum.transmittance -= weight;
}

// What the transfer function says of texel values.
struct Classification {
  float scale;        // to table coordinates
  float bias;
  float visibleLow;   // texels at or below are transparent
  float visibleHigh;  // and those at or above
};

Classification classification(VolumeGrid grid) {
  return Classification(march.tableScale * grid.valueScale, march.tableScale * grid.valueBias + march.tableBias,
                        texelOf(grid, march.visibleLow), texelOf(grid, march.visibleHigh));
}

// True if there may be opacity between the lowest and the highest of some texel values.
bool visible(Classification by, float lowest, float highest) {
  return highest > by.visibleLow && lowest < by.visibleHigh;
}

#ifndef PREINTEGRATED

// Straight colour and opacity of a sample. The sampler clamps.
vec4 classify(Classification by, float texel) {
  return textureLod(table, by.scale * texel + by.bias, 0.0);
}

// Samples at shift, shift + 1, ... before the exit.
void accumulate(VolumeGrid grid, Path path, inout Accumulation sum) {
  Classification by = classification(grid);
  int count = int(ceil(path.places - path.shift));
  for (int i = 0; i < count && goesOn(sum.transmittance); i += kBlock) {
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
      add(grid, path, sampleA, place, true, sum);
      add(grid, path, sampleB, place + 1.0, i + 1 < count, sum);
      add(grid, path, sampleC, place + 2.0, i + 2 < count, sum);
      add(grid, path, sampleD, place + 3.0, i + 3 < count, sum);
    } else if (kCounting) {
      sum.samples += uint(min(kBlock, count - i));
    }
  }
}

#else

// Straight colour and opacity of a slab; colours are interpolated premultiplied.
vec4 classify(Classification by, float front, float back) {
  vec4 slab = textureLod(table, by.scale * vec2(front, back) + by.bias, 0.0);
  return vec4(slab.rgb / max(slab.a, 1e-30), slab.a);
}

// A slab of which only `share` of the length is there. Straight colours keep when the opacity changes. Below the
// largest float under 1 the power is defined.
vec4 cutSlab(vec4 slab, float share) {
  return vec4(slab.rgb, opacityOfStep(min(slab.a, 0.99999994), share));
}

// Slabs between consecutive samples, the last one up to the exit (Engel, Kraus, Ertl 2001). The sample at the
// back of one slab is the front of the next.
void accumulate(VolumeGrid grid, Path path, inout Accumulation sum) {
  Classification by = classification(grid);
  float front = texelAt(grid, path, 0.0);
  if (kCounting) ++sum.samples;
  if (kJitter && path.shift > 0.0) {
    // A shifted grid begins with a part of a slab.
    float share = min(path.shift, path.places);
    float back = texelAt(grid, path, share);
    add(grid, path, cutSlab(classify(by, front, back), share), 0.0, true, sum);
    front = back;
  }
  float slabs = path.places - path.shift;
  int count = int(ceil(slabs));
  for (int i = 0; i < count && goesOn(sum.transmittance); i += kBlock) {
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
      float rest = slabs - float(i);
      if (rest < float(kBlock)) {
        slabA = cutSlab(slabA, clamp(rest, 0.0, 1.0));
        slabB = cutSlab(slabB, clamp(rest - 1.0, 0.0, 1.0));
        slabC = cutSlab(slabC, clamp(rest - 2.0, 0.0, 1.0));
        slabD = cutSlab(slabD, clamp(rest - 3.0, 0.0, 1.0));
      }
      add(grid, path, slabA, place, true, sum);
      add(grid, path, slabB, place + 1.0, i + 1 < count, sum);
      add(grid, path, slabC, place + 2.0, i + 2 < count, sum);
      add(grid, path, slabD, place + 3.0, i + 3 < count, sum);
    } else if (kCounting) {
      sum.samples += uint(min(kBlock, count - i));
    }
    front = d;
  }
}

#endif

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  uint view = gl_WorkGroupID.z;
  VolumeGrid grid = volumeGrid(frame);
  Accumulation sum = Accumulation(vec3(0), 1.0, 0u, 0u);
  bool inPicture = all(lessThan(pixel, frame.size));
  Path path;
  bool entered = inPicture && makePath(grid, pixel, view, path);
  if (entered) {
    accumulate(grid, path, sum);
  }
  if (inPicture) writePixel(pixel, view, vec4(sum.color, 1.0 - sum.transmittance), infinity(), sum.samples);
  countRay(sum.samples, entered, entered && !goesOn(sum.transmittance), sum.gradients);
}
