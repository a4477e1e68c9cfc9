// Occupied regions whose visibility proxies have to find out. Those that reach behind the near plane of a view, or hold
// its eye, are visible without a proxy (not in the paper, whose views were from outside).
// Macros: those of parts/compact.glsl.
// One invocation is one region. proxies.mesh.glsl runs next.
#version 460

#include <direct_rasterization/blocks.glsl>
#include <direct_rasterization/region_box.glsl>

layout(set = 0, binding = kBindingRanges) uniform sampler3D ranges;
layout(set = 0, binding = kBindingVisible, scalar) buffer VisibleBlock {
  uint isVisible[];
};

const int kCounterKept = kCountProxies;

bool holdsSurface(ivec3 region) {
  ivec3 first = region * grid.perRegion;
  ivec3 end = min(first + grid.perRegion, grid.blocks);
  for (int z = first.z; z < end.z; ++z)
    for (int y = first.y; y < end.y; ++y)
      for (int x = first.x; x < end.x; ++x)
        if (isOccupied(texelFetch(ranges, ivec3(x, y, z), 0).xy)) return true;
  return false;
}

bool keeps(uint item) {
  ivec3 region = placeOf(item, grid.regions);
  if (!holdsSurface(region)) return false;
  if (kCounting) addToCounter(uint(kCountRegions), 1u);
  for (uint view = 0u; view < frame.viewCount; ++view) {
    vec2 range = distancesOfRegion(region, frame.views[view]);
    if (range.x < kNearSlack * surface.near && range.y > 0.0) {
      isVisible[item] = 1u;
      return false;
    }
  }
  return true;
}

#include <parts/compact.glsl>
