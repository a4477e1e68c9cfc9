// Whether nodes of an octree are empty, and the way through its levels (Faludi et al. 2021, section 3.4).
#ifndef EMPTY_SPACE_SKIPPING_OCTREE_GLSL
#define EMPTY_SPACE_SKIPPING_OCTREE_GLSL

#include <empty_space_skipping/walk.glsl>

layout(constant_id = kIdBidirectional) const bool kBidirectional = true;

#ifdef MINMAX
layout(set = 0, binding = kBindingStructure) uniform sampler3D octree;
#else
layout(set = 0, binding = kBindingStructure) uniform usampler3D octree;
#endif

#ifdef LABEL_OCTREE_BINDING
layout(set = 0, binding = LABEL_OCTREE_BINDING) uniform usampler3D labelOctree;
#endif

bool isEmpty(Classification by, ivec3 node, int level) {
#ifdef LABEL_OCTREE_BINDING
  if ((texelFetch(labelOctree, node, level) & skipping.shown) == uvec4(0)) return true;
#endif
#if defined(MINMAX)
  vec2 range = texelFetch(octree, node, level).xy;
  return !visible(by, range.x, range.y);
#elif defined(BITFIELD)
  // Components that the format has not are 0 (the last one 1), and so is the mask there.
  uvec4 mask = by.beyond ? skipping.maskBeyond : skipping.mask;
  return (texelFetch(octree, node, level) & mask) == uvec4(0);
#else
  return texelFetch(octree, node, level).x == 0u;
#endif
}

#define QUESTION Classification
#include <parts/octree.glsl>

bool findEmpty(Classification by, inout Walk walk, int index, out int last) {
  return findEmptyNode(by, skipping.blockShift, skipping.initialLevel, kBidirectional, walk, index, last);
}

#endif
