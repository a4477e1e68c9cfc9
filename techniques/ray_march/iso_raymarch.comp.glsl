// Direct isosurface ray casting without acceleration: the reference method of Nysjö, Malmberg, Nyström 2019 (RayCaching),
// section 3.1: march to the first crossing, refine it by bisection, shade it with the gradient.
// One invocation is one pixel of one view (z); a workgroup is 8 x 8 pixels. Nothing runs after it.
#version 460

#include <parts/isosurface_march.glsl>
#include <parts/isosurface_pixel.glsl>
