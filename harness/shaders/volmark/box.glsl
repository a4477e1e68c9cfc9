// Where a ray is inside a box, and inside the volume's box with the clipping planes applied.
#ifndef VOLMARK_BOX_GLSL
#define VOLMARK_BOX_GLSL

#include <volmark/view.glsl>

// The part of a ray inside a convex body, while its half spaces are being applied.
struct RayInterval {
  float entry;     // ray parameter, world units
  float exit;
  vec3 normal;     // of the side entered by, towards the eye
};

// Cuts the interval to dot(normal, p) >= offset. An interval without points has entry > exit.
void cutByPlane(Ray ray, vec3 normal, float offset, inout RayInterval interval) {
  float along = dot(normal, ray.direction);
  float missing = offset - dot(normal, ray.origin);
  if (along == 0.0) {
    if (missing > 0.0) interval.exit = interval.entry - 1.0;
    return;
  }
  float t = missing / along;
  if (along > 0.0 && t > interval.entry) {
    interval.entry = t;
    interval.normal = -normal;
  }
  if (along < 0.0) interval.exit = min(interval.exit, t);
}

// Cuts the interval to low <= p <= high along one axis; low may equal high.
void cutBySlab(float origin, float direction, float low, float high, vec3 axis, inout RayInterval interval) {
  if (direction == 0.0) {
    if (origin < low || origin > high) interval.exit = interval.entry - 1.0;
    return;
  }
  float a = (low - origin) / direction;
  float b = (high - origin) / direction;
  if (min(a, b) > interval.entry) {
    interval.entry = min(a, b);
    interval.normal = direction > 0.0 ? -axis : axis;
  }
  interval.exit = min(interval.exit, max(a, b));
}

// What is ahead of the eye, before any cut: entering nowhere, the normal points back along the ray.
RayInterval wholeRay(Ray ray) {
  return RayInterval(0.0, 3.402823466e38, -ray.direction);
}

void cutByBox(Ray ray, vec3 low, vec3 high, inout RayInterval interval) {
  cutBySlab(ray.origin.x, ray.direction.x, low.x, high.x, vec3(1, 0, 0), interval);
  cutBySlab(ray.origin.y, ray.direction.y, low.y, high.y, vec3(0, 1, 0), interval);
  cutBySlab(ray.origin.z, ray.direction.z, low.z, high.z, vec3(0, 0, 1), interval);
}

// True if the ray meets the closed box, at entry <= t <= exit with entry >= 0. Right for direction components
// of zero and for boxes without thickness.
bool intersectBox(Ray ray, vec3 low, vec3 high, out float entry, out float exit) {
  RayInterval interval = wholeRay(ray);
  cutByBox(ray, low, high, interval);
  entry = interval.entry;
  exit = interval.exit;
  return entry <= exit;
}

// Cuts the interval to the kept side of all clipping planes.
void cutByClippingPlanes(FrameConstants constants, Ray ray, inout RayInterval interval) {
  // A fixed count, so that compilers unroll it and need no copy of the array.
  for (int i = 0; i < kMaxClippingPlanes; ++i)
    if (uint(i) < constants.clippingPlaneCount)
      cutByPlane(ray, constants.clippingPlanes[i].xyz, constants.clippingPlanes[i].w, interval);
}

// The part of the ray inside the box of voxel centres and on the kept side of all clipping planes; false if
// there is none. `entryNormal` is of the box side or plane that the ray enters by and points to the eye (back
// along the ray if the eye is inside).
bool clipRay(FrameConstants constants, Ray ray, out float entry, out float exit, out vec3 entryNormal) {
  RayInterval interval = wholeRay(ray);
  cutByBox(ray, constants.boxMinimum, constants.boxMaximum, interval);
  cutByClippingPlanes(constants, ray, interval);
  entry = interval.entry;
  exit = interval.exit;
  entryNormal = interval.normal;
  return entry <= exit;
}

#endif
