// Direct isosurface ray casting without acceleration: the reference method of Nysjö, Malmberg, Nyström 2019 (RayCaching),
// section 3.1: march to the first crossing, refine it by bisection, shade it with the gradient.
// One invocation is one pixel of one view (z); a workgroup is 8 x 8 pixels. Nothing runs after it.
#version 460

#include <parts/march.glsl>

layout(set = 0, binding = kBindingOwn, rgba32f) uniform writeonly image2DArray normalImage;

// Where the surface is met first, in steps from the entry; -1 if nowhere. `samples` counts.
float findSurface(VolumeGrid grid, Path path, inout uint samples) {
  // Clamped scalars are never below 0 and never above 1.
  float surface = texelOf(grid, frame.isovalue);
  if (frame.isovalue <= 0.0) surface = -infinity();
  if (frame.isovalue > 1.0) surface = infinity();

  ++samples;
  if (texelAt(grid, path, 0.0) >= surface) return 0.0;

  // The ray starts outside, so the first crossing leads inside. Samples lie at integers (shifted by the
  // jitter), the last one at the exit. Blocks of four cost less than four turns of the loop.
  float first = kJitter ? path.shift : 1.0;
  int count = int(ceil(path.places - first)) + 1;
  int i = 0;
  bool inside = false;
  while (i < count && !inside) {
    float place = first + float(i);
    float a = texelAt(grid, path, min(place, path.places));
    float b = texelAt(grid, path, min(place + 1.0, path.places));
    float c = texelAt(grid, path, min(place + 2.0, path.places));
    float d = texelAt(grid, path, min(place + 3.0, path.places));
    inside = max(max(a, b), max(c, d)) >= surface;
    i += a >= surface ? 1 : b >= surface ? 2 : c >= surface ? 3 : 4;
  }
  i = min(i, count);
  samples += uint(i);
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

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  uint view = gl_WorkGroupID.z;
  VolumeGrid grid = volumeGrid(frame);
  vec4 color = vec4(0);
  float distance = infinity();
  uint samples = 0u;
  bool hit = false;
  bool inPicture = all(lessThan(pixel, frame.size));
  Path path;
  bool entered = inPicture && makePath(grid, pixelRay(pixel, view), pixelShift(pixel), false, false, path);
  bool shadedByGradient = false;
  vec3 surfaceNormal = vec3(0); // of counting frames
  if (entered) {
    float place = findSurface(grid, path, samples);
    hit = place >= 0.0;
    if (hit) {
      // What is solid where the ray enters shows the side of the box, or the clipping plane.
      bool atEntry = place == 0.0;
      vec3 world = worldAt(grid, path, place);
      vec3 normal = path.entryNormal;
      if (!atEntry && kShadingModel != kShadingNone) normal = normalAt(grid, world);
      shadedByGradient = !atEntry && kShadingModel != kShadingNone;
      color = vec4(shadeOnPath(path, world, frame.surfaceColor, normal, 1.0), 1.0);
      if (kCounting) surfaceNormal = atEntry || shadedByGradient ? normal : normalAt(grid, world);
      distance = (path.entry + place * march.stepLength) * path.ray.cosine;
    }
  }
  if (inPicture) writePixel(pixel, view, color, distance, samples);
  if (kCounting && inPicture) imageStore(normalImage, texelIn(pixel, view), vec4(surfaceNormal, 0));
  countRay(samples, entered, hit, shadedByGradient ? 1u : 0u);
}
