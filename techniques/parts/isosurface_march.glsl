// Isosurface by marching to the first crossing and bisecting it (Nysjö, Malmberg, Nyström 2019, section 3.1), for compute
// and fragment shaders.
// Macro: SKIPPING, if what includes it has defined, behind <parts/walk.glsl>,
//   Walk makeWalk(VolumeGrid grid, Path path, float shift, int end)
//   bool findEmpty(float surface, inout Walk walk, int index, out int last)   all samples up to `last` are outside
#ifndef PARTS_ISOSURFACE_MARCH_GLSL
#define PARTS_ISOSURFACE_MARCH_GLSL

#include <parts/march.glsl>

// The texel value of the isovalue. Clamped scalars are never below 0 and never above 1.
float surfaceTexel(VolumeGrid grid) {
  if (frame.isovalue <= 0.0) return -infinity();
  return frame.isovalue > 1.0 ? infinity() : texelOf(grid, frame.isovalue);
}

// Where the surface is met first, in steps from the entry; -1 if nowhere. `samples` counts, and `nodes` where something is
// skipped.
float findSurface(VolumeGrid grid, Path path, inout uint samples, inout uint nodes) {
  float surface = surfaceTexel(grid);
  ++samples;
  if (texelAt(grid, path, 0.0) >= surface) return 0.0;

  // The ray starts outside, so the first crossing leads inside. Samples lie at integers (shifted by the
  // jitter), the last one at the exit. Blocks of four cost less than four turns of the loop.
  float first = kJitter ? path.shift : 1.0;
  int count = int(ceil(path.places - first)) + 1;
  int i = 0;
  int skipped = 0;
  bool inside = false;
#ifdef SKIPPING
  Walk walk = makeWalk(grid, path, first, count);
  int last = -1; // sample up to which the answer of the last question holds
  bool empty = false;
#endif
  while (i < count && !inside) {
#ifdef SKIPPING
    if (i > last) {
      empty = findEmpty(surface, walk, i, last);
      if (empty) {
        skipped += last + 1 - i;
        i = last + 1;
      }
    }
    if (!empty) {
#endif
      float place = first + float(i);
      float a = texelAt(grid, path, min(place, path.places));
      float b = texelAt(grid, path, min(place + 1.0, path.places));
      float c = texelAt(grid, path, min(place + 2.0, path.places));
      float d = texelAt(grid, path, min(place + 3.0, path.places));
      inside = max(max(a, b), max(c, d)) >= surface;
      i += a >= surface ? 1 : b >= surface ? 2 : c >= surface ? 3 : 4;
#ifdef SKIPPING
    }
#endif
  }
  i = min(i, count);
  samples += uint(i - skipped);
#ifdef SKIPPING
  nodes += walk.nodes;
#endif
  if (!inside) return -1.0;

  // Halve the interval between the last place outside and the first one inside.
  float outer = max(first + float(i - 2), 0.0);
  float inner = min(first + float(i - 1), path.places);
  for (uint k = 0u; k < march.bisections; ++k) {
    float middle = 0.5 * (outer + inner);
    bool beyond = texelAt(grid, path, middle) >= surface;
    inner = beyond ? middle : inner;
    outer = beyond ? outer : middle;
  }
  samples += march.bisections;
  return 0.5 * (outer + inner);
}

// What one ray finds.
struct SurfaceHit {
  vec4 color;     // 0 where nothing is
  float distance; // along the view direction
  vec3 normal;    // of counting frames
  bool entered;   // the volume
  bool hit;
  bool shadedByGradient;
  uint samples;
  uint nodes;
};

SurfaceHit marchSurface(ivec2 pixel, uint view, bool inPicture) {
  VolumeGrid grid = volumeGrid(frame);
  SurfaceHit result = SurfaceHit(vec4(0), infinity(), vec3(0), false, false, false, 0u, 0u);
  Path path;
  result.entered = inPicture && makePath(grid, pixelRay(pixel, view), pixelShift(pixel), false, false, path);
  if (!result.entered) return result;
  float place = findSurface(grid, path, result.samples, result.nodes);
  result.hit = place >= 0.0;
  if (!result.hit) return result;
  // What is solid where the ray enters shows the side of the box, or the clipping plane.
  bool atEntry = place == 0.0;
  vec3 world = worldAt(grid, path, place);
  vec3 normal = path.entryNormal;
  result.shadedByGradient = !atEntry && kShadingModel != kShadingNone;
  if (result.shadedByGradient) normal = normalAt(grid, world);
  result.color = vec4(shadeOnPath(path, world, frame.surfaceColor, normal, 1.0), 1.0);
  if (kCounting) result.normal = atEntry || result.shadedByGradient ? normal : normalAt(grid, world);
  result.distance = (path.entry + place * march.stepLength) * path.ray.cosine;
  return result;
}

#endif
