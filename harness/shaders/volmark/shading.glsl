// Shading of surfaces and samples; the formulas are defined in harness/README.md, Shading.
#ifndef VOLMARK_SHADING_GLSL
#define VOLMARK_SHADING_GLSL

#include <volmark/frame.glsl>

// The values of ShadingModel (volmark/scene.h).
const uint kShadingNone = 0u;
const uint kShadingLambert = 1u;
const uint kShadingPhong = 2u;
const uint kShadingGooch = 3u;
const uint kShadingGgx = 4u;

// Unit normal towards lower values, or zero where the gradient (per world unit) is shorter than 1e-6.
vec3 normalOfGradient(vec3 gradient) {
  float size = length(gradient);
  return size < 1e-6 ? vec3(0) : -gradient / size;
}

// Blinn's highlight, exponent 32, where the light reaches the surface.
vec3 specular(vec3 normal, vec3 toLight, vec3 toEye, vec3 lightColor) {
  if (dot(normal, toLight) <= 0.0) return vec3(0);
  // Repeated squares: pow() is an approximation on some devices.
  float power = max(dot(normal, normalize(toLight + toEye)), 0.0);
  for (int i = 0; i < 5; ++i) power *= power;
  return 0.3 * power * lightColor;
}

float toTheFifth(float x) {
  float square = x * x;
  return square * square * x;
}

// Disney's diffuse term and a GGX lobe of roughness 0.5, for a normal on the eye's side.
vec3 shadeGgx(vec3 color, vec3 n, vec3 toLight, vec3 toEye, vec3 lightColor, float ambient) {
  const float kAlpha2 = 0.0625;
  float nl = dot(n, toLight);
  if (nl <= 0.0) return ambient * color;
  vec3 h = normalize(toLight + toEye);
  float nv = max(dot(n, toEye), 0.0);
  float nh = dot(n, h);
  float lh = dot(toLight, h);
  float grazing = lh * lh - 0.5;
  float diffuse = (1.0 + grazing * toTheFifth(1.0 - nl)) * (1.0 + grazing * toTheFifth(1.0 - nv));
  float spread = nh * nh * (kAlpha2 - 1.0) + 1.0;
  float visibility = 0.5 / (nl * sqrt(nv * nv * (1.0 - kAlpha2) + kAlpha2) +
                            nv * sqrt(nl * nl * (1.0 - kAlpha2) + kAlpha2) + 1e-5);
  float fresnel = 0.04 + 0.96 * toTheFifth(1.0 - lh);
  float lobe = kAlpha2 / (spread * spread) * visibility * fresnel;
  return ambient * color + nl * lightColor * ((1.0 - ambient) * diffuse * color + lobe);
}

// Linear colour, not clamped. `normal`, `toLight` and `toEye` are unit vectors; the normal may point either way
// and is turned towards the eye; a zero normal (no gradient) gives `color`.
vec3 shade(uint model, vec3 color, vec3 normal, vec3 toLight, vec3 toEye, vec3 lightColor, float ambient) {
  if (model == kShadingNone || dot(normal, normal) == 0.0) return color;
  vec3 n = dot(normal, toEye) < 0.0 ? -normal : normal;
  float lambert = dot(n, toLight);
  if (model == kShadingGooch) {
    vec3 cool = vec3(0.0, 0.0, 0.4) + 0.25 * color;
    vec3 warm = vec3(0.4, 0.4, 0.0) + 0.5 * color;
    return mix(cool, warm, 0.5 * (1.0 + lambert)) + specular(n, toLight, toEye, lightColor);
  }
  if (model == kShadingGgx) return shadeGgx(color, n, toLight, toEye, lightColor, ambient);
  vec3 diffuse = color * (ambient + (1.0 - ambient) * lightColor * max(lambert, 0.0));
  if (model == kShadingPhong) diffuse += specular(n, toLight, toEye, lightColor);
  return diffuse;
}

// Unit vector from a place (world) to the frame's light; `toEye` is minus the ray's direction. A headlight shines from
// the eye.
vec3 towardsLight(FrameConstants constants, vec3 world, vec3 toEye) {
  if (constants.headlight != 0u) return toEye;
  return constants.light.w == 0.0 ? constants.light.xyz : normalize(constants.light.xyz - world);
}

#endif
