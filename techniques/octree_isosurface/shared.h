// What the host code and the shader of this family share, beside parts/shared.h. Scalar layout.
#ifndef OCTREE_ISOSURFACE_SHARED_H
#define OCTREE_ISOSURFACE_SHARED_H

#include <parts/shared.h>

#ifdef __cplusplus
namespace volmark::octree_isosurface {
using parts::kBindingOwn;
using parts::kIdOwn;
#endif

// Bindings after the image of normals, specialisation constants.
const int kBindingConstants = kBindingOwn + 1;
const int kBindingOctree = kBindingOwn + 2;
const int kIdBidirectional = kIdOwn; // go on at the level of the last question

struct OctreeConstants {
  int blockShift;   // log2 of the cells along a leaf's edge
  int initialLevel; // highest level asked; 0 are the leaves
  float margin;     // texel value: what rounding may add to a sample
};

#ifdef __cplusplus
static_assert(sizeof(OctreeConstants) == 12);
} // namespace volmark::octree_isosurface
#endif

#endif
