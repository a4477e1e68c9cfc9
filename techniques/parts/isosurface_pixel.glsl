// The main function of isosurface ray marchers. One invocation is one pixel of one view; nothing runs after it.
// Macro: FRAGMENT, in fragment shaders.
#ifndef PARTS_ISOSURFACE_PIXEL_GLSL
#define PARTS_ISOSURFACE_PIXEL_GLSL

#include <parts/isosurface_march.glsl>

layout(set = 0, binding = kBindingOwn, rgba32f) uniform writeonly image2DArray normalImage;

void main() {
#ifdef FRAGMENT
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  uint view = march.view;
#else
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  uint view = gl_WorkGroupID.z;
#endif
  bool inPicture = all(lessThan(pixel, frame.size));
  SurfaceHit hit = marchSurface(pixel, view, inPicture);
  if (inPicture) writePixel(pixel, view, hit.color, hit.distance, hit.samples);
  if (kCounting && inPicture) imageStore(normalImage, texelIn(pixel, view), vec4(hit.normal, 0));
  countRay(hit.samples, hit.entered, hit.hit, hit.shadedByGradient ? 1u : 0u);
  if (kCounting) countUp(kCounterNodes, hit.nodes);
}

#endif
