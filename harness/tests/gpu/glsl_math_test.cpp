// The GLSL includes that need no volume, against the same mathematics in C++.
#include "gpu_test.h"
#include "volmark/random.h"
#include "volmark/shared/frame_constants.h"
#include "volmark/transfer_function.h"
#include "volmark/view.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace volmark::gpu::test {

namespace {

using GlslTest = GpuTest;
using glm::dvec3;

View testView() {
  View view;
  view.pose = Pose::lookAt({30, -20, 55}, {1, 2, 3}, {0, 0, 1});
  view.frustum = {-0.4, 0.3, -0.25, 0.35}; // off-centre on purpose
  return view;
}

ViewConstants constantsOf(const View& view) {
  const Frustum& f = view.frustum;
  return {vec3(view.pose.position), vec3(view.pose.right), vec3(view.pose.up), vec3(view.pose.forward),
          vec4(f.left, f.right, f.down, f.up)};
}

/// Entry and exit of a ray by brute force over the planes of a box, in double precision.
struct Interval {
  double entry = 0;
  double exit = 1e30;
  bool hit = true;
};

Interval intersect(const dvec3& origin, const dvec3& direction, const dvec3& low, const dvec3& high) {
  Interval result;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) {
      result.hit = result.hit && origin[axis] >= low[axis] && origin[axis] <= high[axis];
      continue;
    }
    const double a = (low[axis] - origin[axis]) / direction[axis];
    const double b = (high[axis] - origin[axis]) / direction[axis];
    result.entry = std::max(result.entry, std::min(a, b));
    result.exit = std::min(result.exit, std::max(a, b));
  }
  result.hit = result.hit && result.entry <= result.exit;
  return result;
}

struct BoxCase {
  vec3 origin, direction, low, high;
};

std::vector<BoxCase> boxCases() {
  std::vector<BoxCase> cases = {
      {{0, 0, 5}, {0, 0, -1}, {-1, -1, -1}, {1, 1, 1}},  // two zero components
      {{2, 0, 5}, {0, 0, -1}, {-1, -1, -1}, {1, 1, 1}},  // beside the box
      {{1, 0, 5}, {0, 0, -1}, {-1, -1, -1}, {1, 1, 1}},  // along a side
      {{0, 0, 0}, {0, 1, 0}, {-1, -1, -1}, {1, 1, 1}},   // from inside
      {{0, 0, -5}, {0, 0, -1}, {-1, -1, -1}, {1, 1, 1}}, // behind
      {{0, 0, 5}, {0, 0, -1}, {-1, -1, 0}, {1, 1, 0}},   // no thickness across the ray
      {{0, 0, 5}, {0, 0, -1}, {0, -1, -1}, {0, 1, 1}},   // no thickness, ray inside the plane
      {{0.5, 0, 5}, {0, 0, -1}, {0, -1, -1}, {0, 1, 1}}, // no thickness, ray beside it
      {{0, 0, 5}, {-0.0f, -0.0f, -1}, {-1, -1, -1}, {1, 1, 1}},
  };
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-3, 3);
  const auto point = [&] { return vec3(uniform(random), uniform(random), uniform(random)); };
  for (int i = 0; i < 500; ++i) {
    const vec3 a = point(), b = point();
    const vec3 origin = 2.0f * point();
    const vec3 target = i % 2 ? point() : glm::mix(a, b, 0.25f); // every other one meets the box
    cases.push_back({origin, glm::normalize(target - origin), glm::min(a, b), glm::max(a, b)});
  }
  return cases;
}

/// harness/README.md, Shading, written again.
dvec3 shade(int model, const dvec3& c, dvec3 n, const dvec3& l, const dvec3& v, const dvec3& light, double ambient) {
  if (model == 0 || n == dvec3(0)) return c;
  if (glm::dot(n, v) < 0) n = -n;
  const double nl = glm::dot(n, l);
  const double highlight = nl > 0 ? 0.3 * std::pow(std::max(glm::dot(n, glm::normalize(l + v)), 0.0), 32) : 0;
  const dvec3 lambert = c * (ambient + (1 - ambient) * light * std::max(nl, 0.0));
  if (model == 1) return lambert;
  if (model == 2) return lambert + highlight * light;
  const dvec3 cool = dvec3(0, 0, 0.4) + 0.25 * c, warm = dvec3(0.4, 0.4, 0) + 0.5 * c;
  return glm::mix(cool, warm, (1 + nl) / 2) + highlight * light;
}

} // namespace

TEST_F(GlslTest, RandomNumbersAreTheHostsBitForBit) {
  constexpr int count = 4096;
  const auto bits = evaluate<std::uint32_t>("uint", count, "#include <volmark/random.glsl>",
                                            "result[i] = randomBits(uint(i) * 977u, uint(i / 7), 3u, uint(i % 11));");
  const auto units =
      evaluate<float>("float", count, "#include <volmark/random.glsl>", "result[i] = toUnitFloat(hash(uint(i)));");
  for (std::uint32_t i = 0; i < count; ++i) {
    ASSERT_EQ(bits[i], randomBits(i * 977u, i / 7, 3, i % 11));
    ASSERT_EQ(units[i], toUnitFloat(hash(i)));
  }
}

TEST_F(GlslTest, RaysAreTheHosts) {
  const View view = testView();
  const ivec2 size(37, 21);
  const Buffer views = bufferOf<ViewConstants>({constantsOf(view)});
  struct Result {
    vec3 origin, direction;
    float cosine;
    vec4 clip;
  };
  const auto rays = evaluate<Result>("Result", 37 * 21,
                                     "#include <volmark/view.glsl>\n"
                                     "layout(binding = 1, scalar) readonly buffer V { ViewConstants view; };\n"
                                     "struct Result { vec3 origin; vec3 direction; float cosine; vec4 clip; };",
                                     "ivec2 size = ivec2(37, 21);\n"
                                     "Ray ray = rayThroughPixel(view, ivec2(i % 37, i / 37), size);\n"
                                     "result[i] = Result(ray.origin, ray.direction, ray.cosine,\n"
                                     "  clipPosition(view, pointOnRay(ray, 12.0), 1.0));",
                                     {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER}, {views.range()});
  for (int i = 0; i < size.x * size.y; ++i) {
    const int x = i % size.x, y = i / size.x;
    const Ray ray = rayThroughPixel(view, x, y, size.x, size.y);
    const Result& found = rays[static_cast<std::size_t>(i)];
    ASSERT_LT(glm::distance(dvec3(found.direction), ray.direction), 1e-6);
    ASSERT_NEAR(found.cosine, ray.cosine, 1e-6);
    ASSERT_EQ(found.origin, vec3(ray.origin));
    // A rasterised point of the ray falls on the same pixel's centre.
    ASSERT_NEAR((found.clip.x / found.clip.w * 0.5 + 0.5) * size.x, x + 0.5, 1e-3);
    ASSERT_NEAR((found.clip.y / found.clip.w * 0.5 + 0.5) * size.y, y + 0.5, 1e-3);
    ASSERT_NEAR(found.clip.w, 12 * ray.cosine, 1e-4);
    ASSERT_NEAR(found.clip.z / found.clip.w, 1 / (12 * ray.cosine), 1e-6);
  }
}

TEST_F(GlslTest, BoxesAreMetWhereTheyAre) {
  const auto cases = boxCases();
  const Buffer input = bufferOf(cases);
  const auto found = evaluate<vec3>(
      "vec3", cases.size(),
      "#include <volmark/box.glsl>\n"
      "struct BoxCase { vec3 origin; vec3 direction; vec3 low; vec3 high; };\n"
      "layout(binding = 1, scalar) readonly buffer Cases { BoxCase cases[]; };",
      "float entry, exit;\n"
      "bool hit = intersectBox(Ray(cases[i].origin, cases[i].direction, 1.0), cases[i].low, cases[i].high,\n"
      "                        entry, exit);\n"
      "result[i] = vec3(hit ? 1.0 : 0.0, entry, exit);",
      {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER}, {input.range()});
  int hits = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const BoxCase& c = cases[i];
    const Interval expected = intersect(c.origin, c.direction, c.low, c.high);
    if (std::abs(expected.entry - expected.exit) < 1e-5 && c.low != c.high && i >= 9) continue; // grazes an edge
    ASSERT_EQ(found[i].x > 0, expected.hit) << "case " << i;
    if (!expected.hit) continue;
    ++hits;
    ASSERT_NEAR(found[i].y, expected.entry, 1e-5 * (1 + std::abs(expected.entry))) << "case " << i;
    ASSERT_NEAR(found[i].z, expected.exit, 1e-5 * (1 + std::abs(expected.exit))) << "case " << i;
    ASSERT_GE(found[i].y, 0);
  }
  EXPECT_GT(hits, 250);
}

TEST_F(GlslTest, ClippedRaysKnowTheSideTheyEnterBy) {
  FrameConstants constants{};
  constants.boxMinimum = vec3(-1, -2, -3);
  constants.boxMaximum = vec3(1, 2, 3);
  constants.clippingPlanes[0] = vec4(0, 0, -1, -1); // keeps z <= 1
  constants.clippingPlanes[1] = vec4(glm::normalize(vec3(1, 1, 0)), -0.5f);
  constants.clippingPlanes[2] = vec4(0, 0, 1, 100); // keeps nothing, not counted
  constants.clippingPlaneCount = 2;
  struct Case {
    vec3 origin, direction;
    bool hit;
    float entry, exit;
    vec3 normal;
  };
  const float diagonal = std::sqrt(2.0f);
  const std::vector<Case> cases = {
      {{0, 0, 10}, {0, 0, -1}, true, 9, 13, {0, 0, 1}},                   // by the first plane
      {{0, 0, -10}, {0, 0, 1}, true, 7, 11, {0, 0, -1}},                  // by a side, leaves by the plane
      {{10, 0, 0}, {-1, 0, 0}, true, 9, 10 + 0.5f * diagonal, {1, 0, 0}}, // by a side, leaves by the second plane
      {{-10, 0, 0}, {1, 0, 0}, true, 10 - 0.5f * diagonal, 11, vec3(-1, -1, 0) / diagonal},
      {{0, 0, 2}, {1, 0, 0}, false, 0, 0, {}},                            // beyond the first plane, along it
      {{0, 0, 0}, {0, 1, 0}, true, 0, 2, {0, -1, 0}},                     // the eye is inside
      {{0, 10, 1}, {0, -1, 0}, true, 8, 10 + 0.5f * diagonal, {0, 1, 0}}, // inside the first plane
  };
  std::vector<vec3> rays;
  for (const Case& c : cases)
    rays.insert(rays.end(), {c.origin, c.direction});
  const Buffer frame = bufferOf<FrameConstants>({constants});
  const Buffer input = bufferOf(rays);
  struct Result {
    std::uint32_t hit;
    float entry, exit;
    vec3 normal;
  };
  const auto found = evaluate<Result>("Result", cases.size(),
                                      "#include <volmark/box.glsl>\nVOLMARK_FRAME(1)\n"
                                      "layout(binding = 2, scalar) readonly buffer Rays { vec3 rays[]; };\n"
                                      "struct Result { uint hit; float entry; float exit; vec3 normal; };",
                                      "Ray ray = Ray(rays[2 * i], rays[2 * i + 1], 1.0);\n"
                                      "float entry, exit; vec3 normal;\n"
                                      "bool hit = clipRay(frame, ray, entry, exit, normal);\n"
                                      "result[i] = Result(uint(hit), entry, exit, normal);",
                                      {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
                                      {frame.range(), input.range()});
  for (std::size_t i = 0; i < cases.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(found[i].hit != 0, cases[i].hit);
    if (!cases[i].hit) continue;
    EXPECT_NEAR(found[i].entry, cases[i].entry, 1e-5);
    EXPECT_NEAR(found[i].exit, cases[i].exit, 1e-5);
    EXPECT_LT(glm::distance(found[i].normal, cases[i].normal), 1e-6f);
  }
}

TEST_F(GlslTest, ShadingFollowsTheFormulas) {
  std::mt19937 random(9);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> uniform(0, 1);
  const auto direction = [&] { return glm::normalize(vec3(normal(random), normal(random), normal(random))); };
  struct Case {
    std::uint32_t model;
    vec3 color, normal, toLight, toEye, light;
    float ambient;
  };
  std::vector<Case> cases;
  for (std::uint32_t i = 0; i < 800; ++i) {
    const vec3 n = i % 50 == 0 ? vec3(0) : direction();
    const vec3 eye = direction();
    // Half of the lights near the eye's mirror, so that highlights are seen.
    const vec3 light = i % 2 ? direction() : glm::normalize(2 * glm::dot(n, eye) * n - eye + 0.1f * direction());
    cases.push_back({i % 4,
                     {uniform(random), uniform(random), uniform(random)},
                     n,
                     light,
                     eye,
                     {uniform(random), uniform(random), uniform(random)},
                     uniform(random)});
  }
  const Buffer input = bufferOf(cases);
  const auto found = evaluate<vec3>(
      "vec3", cases.size(),
      "#include <volmark/shading.glsl>\n"
      "struct Case { uint model; vec3 color; vec3 normal; vec3 toLight; vec3 toEye; vec3 light; float ambient; };\n"
      "layout(binding = 1, scalar) readonly buffer Cases { Case cases[]; };",
      "Case c = cases[i];\nresult[i] = shade(c.model, c.color, c.normal, c.toLight, c.toEye, c.light, c.ambient);",
      {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER}, {input.range()});
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    const dvec3 expected = shade(static_cast<int>(c.model), c.color, c.normal, c.toLight, c.toEye, c.light,
                                 static_cast<double>(c.ambient));
    ASSERT_LT(glm::distance(dvec3(found[i]), expected), 2e-5) << "case " << i << " model " << c.model;
  }
}

TEST_F(GlslTest, NormalsNeedAGradient) {
  const auto found = evaluate<vec3>("vec3", 3, "#include <volmark/shading.glsl>",
                                    "result[i] = normalOfGradient(i == 0 ? vec3(0) : i == 1 ? vec3(9e-7, 0, 0)\n"
                                    "                                    : vec3(0, 3e-6, 4e-6));");
  EXPECT_EQ(found[0], vec3(0));
  EXPECT_EQ(found[1], vec3(0));
  EXPECT_LT(glm::distance(found[2], vec3(0, -0.6f, -0.8f)), 1e-6f);
}

TEST_F(GlslTest, OpacityIsCorrectedForTheStep) {
  constexpr int count = 2000;
  const std::string opacity = "float a = 0.9999 * pow(float(i) / 1999.0, 3.0); float s = 0.05 * float(1 + i % 80);";
  const auto found = evaluate<vec3>("vec3", count, "#include <volmark/transfer_function.glsl>",
                                    opacity + "result[i] = vec3(a, s, opacityOfStep(a, s));");
  double worst = 0;
  for (const vec3& f : found) {
    const double expected = 1 - std::pow(1 - double(f.x), double(f.y));
    worst = std::max(worst, std::abs(f.z - expected));
  }
  // A ray of 400 samples must stay within half float's resolution (5e-4).
  EXPECT_LT(worst, 1e-6);
}

TEST_F(GlslTest, SlabsAreShortenedConsistently) {
  // Two halves of a slab of constant colour composited give the slab.
  const auto found = evaluate<vec4>("vec4", 100, "#include <volmark/transfer_function.glsl>",
                                    "float a = float(i) / 100.0; vec4 slab = vec4(vec3(0.2, 0.5, 0.9) * a, a);\n"
                                    "vec4 sum = shortenSlab(slab, 0.3); composite(sum, shortenSlab(slab, 0.7));\n"
                                    "result[i] = sum - slab;");
  for (const vec4& difference : found)
    EXPECT_LT(glm::length(difference), 3e-6f);
}

TEST_F(GlslTest, TablesInterpolateLinearly) {
  const TransferFunction function("test", {{0.1, {1, 0, 0}, 0.0}, {0.5, {0, 1, 0}, 0.8}, {0.9, {0, 0, 1}, 0.2}});
  constexpr int count = 1001;
  const auto table = function.table(11); // all points lie on entries: the table is exact
  const auto preintegrated = function.preintegratedTable(11, 1.0);
  const Buffer tableBuffer = bufferOf(table);
  const Buffer preintegratedBuffer = bufferOf(preintegrated);
  const std::vector<VkDescriptorType> types(2, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
  const std::vector<Resource> resources = {tableBuffer.range(), preintegratedBuffer.range()};
  const std::string declarations = "#include <volmark/transfer_function.glsl>\n"
                                   "VOLMARK_TRANSFER_FUNCTION(1)\nVOLMARK_PREINTEGRATED_TABLE(2, 11)";
  const auto values = evaluate<vec4>("vec4", count, declarations,
                                     "result[i] = transferFunction(float(i) / 1000.0) + 0.0 * preintegrated(0.0, 0.0);",
                                     types, resources);
  for (int i = 0; i < count; ++i)
    ASSERT_LT(glm::distance(values[static_cast<std::size_t>(i)], vec4(function.evaluate(i / 1000.0))), 2e-6f) << i;

  // At the entries the table itself; half way between two, their mean. Column is front, row is back.
  const auto at = [&](int front, int back) { return preintegrated[static_cast<std::size_t>(back * 11 + front)]; };
  const auto slabs =
      evaluate<vec4>("vec4", 121, declarations,
                     "vec2 place = vec2(i % 11, i / 11); vec2 next = min(place + vec2(0.5, 0), 10.0);\n"
                     "result[i] = transferFunction(0.0) * 0.0 + preintegrated(next.x / 10.0, next.y / 10.0);",
                     types, resources);
  for (int i = 0; i < 121; ++i) {
    const int front = i % 11, back = i / 11;
    const vec4 expected = 0.5f * (at(front, back) + at(std::min(front + 1, 10), back));
    ASSERT_LT(glm::distance(slabs[static_cast<std::size_t>(i)], expected), 2e-6f) << front << ' ' << back;
  }
}

} // namespace volmark::gpu::test
