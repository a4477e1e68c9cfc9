// Shadows by a map of opacities seen from the light. "Opacity shadow maps" (Kim and Neumann 2001) hold a ray's opacity at
// fixed depths; this one holds the depths of fixed opacities, so that surfaces lie where they are with few values.
#ifndef PARTS_SHADOWS_GLSL
#define PARTS_SHADOWS_GLSL

#include <parts/march.glsl>

layout(set = 0, binding = SHADOWS_BINDING) uniform sampler2D shadowMap;

// Share of the spotlight's light that arrives at a place in the volume, to 1/(2 kShadowDepths) of it: how many of the
// depths lie behind it, interpolated between the four rays around it.
float shareThatArrives(vec3 world) {
  vec3 fromLight = world - frame.light.xyz;
  float depth = length(fromLight) - march.shadowBias;
  vec2 tangents = vec2(dot(fromLight, march.shadowRight), dot(fromLight, march.shadowUp)) /
                  dot(fromLight, march.shadowForward);
  vec2 place = (0.5 * tangents / march.shadowTangent + 0.5) * float(march.shadowSize) - 0.5;
  place = clamp(place, vec2(0), vec2(march.shadowSize - 1));
  ivec2 low = ivec2(place);
  ivec2 high = min(low + 1, march.shadowSize - 1);
  vec2 share = place - vec2(low);
  vec4 a = vec4(greaterThanEqual(texelFetch(shadowMap, low, 0), vec4(depth)));
  vec4 b = vec4(greaterThanEqual(texelFetch(shadowMap, ivec2(high.x, low.y), 0), vec4(depth)));
  vec4 c = vec4(greaterThanEqual(texelFetch(shadowMap, ivec2(low.x, high.y), 0), vec4(depth)));
  vec4 d = vec4(greaterThanEqual(texelFetch(shadowMap, high, 0), vec4(depth)));
  vec4 lit = mix(mix(a, b, share.x), mix(c, d, share.x), share.y);
  return dot(lit, vec4(1.0 / float(kShadowDepths)));
}

#endif
