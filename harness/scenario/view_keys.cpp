#include "scenario/key_makers.h"

#include <fmt/format.h>

namespace volmark {

namespace {

using namespace keys;

constexpr std::int64_t kLargestResolution = 16384;
constexpr std::size_t kMostCameraKeys = 10000;

PointKey resolution() {
  const nlohmann::json side = {{"type", "integer"}, {"minimum", 1}, {"maximum", kLargestResolution}};
  return plain(
      "resolution", "pixels", "Width and height of one view.",
      {{"type", "array"}, {"items", side}, {"minItems", 2}, {"maxItems", 2}},
      [](const JsonValue& value, PointSettings& s) {
        const std::vector<JsonValue> sides = value.array();
        if (sides.size() != 2) value.refuse(fmt::format("[width, height], each integer 1 to {}", kLargestResolution));
        s.width = static_cast<int>(sides[0].integer(1, kLargestResolution));
        s.height = static_cast<int>(sides[1].integer(1, kLargestResolution));
      },
      [](const PointSettings& s) {
        return nlohmann::json{s.width, s.height};
      });
}

PointKey cameraDistance() {
  return plain(
      "camera.distance", "mm", "From the volume's centre; fit: the bounding sphere fills the smaller field of view.",
      {{"anyOf", {{{"const", "fit"}}, {{"type", "number"}, {"minimum", 1e-6}, {"maximum", 1e9}}}}},
      [](const JsonValue& value, PointSettings& s) {
        if (value.json() == "fit") {
          s.camera.distanceMm.reset();
          return;
        }
        if (!value.json().is_number()) value.refuse("\"fit\" or number 1e-06 to 1e+09");
        s.camera.distanceMm = value.number(1e-6, 1e9);
      },
      [](const PointSettings& s) {
        return s.camera.distanceMm ? nlohmann::json(*s.camera.distanceMm) : nlohmann::json("fit");
      });
}

// --- Key poses -----------------------------------------------------------------------------------------------

nlohmann::json cameraKeySchema() {
  return {{"type", "object"},
          {"properties",
           {{"azimuth_degrees", numberSchema(-36000, 36000)},
            {"elevation_degrees", numberSchema(-90, 90)},
            {"distance_scale", numberSchema(0.01, 100)},
            {"cut", {{"type", "boolean"}}}}},
          {"additionalProperties", false}};
}

CameraPath::Key readCameraKey(const JsonValue& value) {
  CameraPath::Key key;
  JsonObject object(value);
  if (const auto v = object.find("azimuth_degrees")) key.azimuthDegrees = v->number(-36000, 36000);
  if (const auto v = object.find("elevation_degrees")) key.elevationDegrees = v->number(-90, 90);
  if (const auto v = object.find("distance_scale")) key.distanceScale = v->number(0.01, 100);
  if (const auto v = object.find("cut")) key.cut = v->boolean();
  object.refuseOthers();
  return key;
}

nlohmann::json writeCameraKey(const CameraPath::Key& key) {
  return {{"azimuth_degrees", canonical(key.azimuthDegrees)},
          {"elevation_degrees", canonical(key.elevationDegrees)},
          {"distance_scale", canonical(key.distanceScale)},
          {"cut", key.cut}};
}

PointKey cameraKeys() {
  return plain(
      "timeline.keys", "", "Key poses at equal intervals, linear in between; cut: the camera jumps there.",
      {{"type", "array"}, {"items", cameraKeySchema()}, {"maxItems", kMostCameraKeys}},
      [](const JsonValue& value, PointSettings& s) {
        const std::vector<JsonValue> keys = value.array();
        if (keys.size() > kMostCameraKeys)
          value.fail(fmt::format("found {} keys, allowed: {}", keys.size(), kMostCameraKeys));
        s.timeline.camera.keys.clear();
        for (const JsonValue& key : keys)
          s.timeline.camera.keys.push_back(readCameraKey(key));
      },
      [](const PointSettings& s) {
        nlohmann::json result = nlohmann::json::array();
        for (const CameraPath::Key& key : s.timeline.camera.keys)
          result.push_back(writeCameraKey(key));
        return result;
      });
}

// --- Isovalue sweep and clipping planes ----------------------------------------------------------------------

PointKey isovalueSweep() {
  PointKey key = plain(
      "timeline.isovalue_sweep", "", "Isovalue at the timeline's ends, linear in between; null: none.",
      {{"anyOf",
        {{{"type", "null"}},
         {{"type", "object"},
          {"properties", {{"from", isovalueSchema()}, {"to", isovalueSchema()}}},
          {"required", {"from", "to"}},
          {"additionalProperties", false}}}}},
      [](const JsonValue& value, PointSettings& s) {
        JsonObject object(value);
        const JsonValue from = object.at("from");
        const JsonValue to = object.at("to");
        object.refuseOthers();
        s.timeline.isovalueSweep = {resolveIsovalue(from, s.scene), resolveIsovalue(to, s.scene)};
      },
      [](const PointSettings& s) {
        if (!s.timeline.isovalueSweep) return nlohmann::json();
        return nlohmann::json{{"from", toJson(s.timeline.isovalueSweep->first)},
                              {"to", toJson(s.timeline.isovalueSweep->second)}};
      });
  key.check = [](const JsonValue& value) {
    JsonObject object(value);
    checkIsovalue(object.at("from"));
    checkIsovalue(object.at("to"));
    object.refuseOthers();
  };
  return key;
}

PointKey blend() {
  PointKey key = plain(
      "timeline.blend", "",
      "The transfer function moves to another one and back by a sine, in whole or part cycles; null: none.",
      {{"anyOf",
        {{{"type", "null"}},
         {{"type", "object"},
          {"properties", {{"to", transferFunctionSchema()}, {"cycles", numberSchema(0, 1000)}}},
          {"required", {"to"}},
          {"additionalProperties", false}}}}},
      [](const JsonValue& value, PointSettings& s) {
        JsonObject object(value);
        TransferFunctionBlend read{.to = resolveTransferFunction(object.at("to"), s.scene)};
        if (const auto cycles = object.find("cycles")) read.cycles = cycles->number(0, 1000);
        object.refuseOthers();
        s.timeline.blend = std::move(read);
      },
      [](const PointSettings& s) {
        if (!s.timeline.blend) return nlohmann::json();
        return nlohmann::json{{"to", toJson(*s.timeline.blend->to)}, {"cycles", canonical(s.timeline.blend->cycles)}};
      });
  key.check = [](const JsonValue& value) {
    JsonObject object(value);
    checkTransferFunction(object.at("to"));
    if (const auto cycles = object.find("cycles")) cycles->number(0, 1000);
    object.refuseOthers();
  };
  return key;
}

ClippingPlane readClippingPlane(const JsonValue& value) {
  ClippingPlane plane;
  JsonObject object(value);
  plane.normal = directionFrom(object.at("normal"));
  if (const auto offset = object.find("offset")) plane.offset = offset->number(-1e9, 1e9);
  object.refuseOthers();
  return plane;
}

PointKey clippingPlanes() {
  const nlohmann::json plane = {
      {"type", "object"},
      {"properties", {{"normal", vectorSchema(-1e9, 1e9)}, {"offset", numberSchema(-1e9, 1e9)}}},
      {"required", {"normal"}},
      {"additionalProperties", false}};
  return plain(
      "timeline.clipping_planes", "", "Half spaces dot(normal, p) >= offset (mm) that are kept.",
      {{"type", "array"}, {"items", plane}, {"maxItems", kMaximumClippingPlanes}},
      [](const JsonValue& value, PointSettings& s) {
        const std::vector<JsonValue> planes = value.array();
        if (planes.size() > kMaximumClippingPlanes)
          value.fail(fmt::format("found {} clipping planes, allowed: {}", planes.size(), kMaximumClippingPlanes));
        s.timeline.clippingPlanes.clear();
        for (const JsonValue& one : planes)
          s.timeline.clippingPlanes.push_back(readClippingPlane(one));
      },
      [](const PointSettings& s) {
        nlohmann::json result = nlohmann::json::array();
        for (const ClippingPlane& one : s.timeline.clippingPlanes)
          result.push_back({{"normal", toJson(one.normal)}, {"offset", canonical(one.offset)}});
        return result;
      });
}

bool onKeys(const PointSettings& s) {
  return s.timeline.camera.kind == CameraPath::Kind::keys;
}
bool notOnKeys(const PointSettings& s) {
  return !onKeys(s);
}
bool onOrbit(const PointSettings& s) {
  return s.timeline.camera.kind == CameraPath::Kind::orbit;
}

} // namespace

std::vector<PointKey> viewKeys() {
  using Kind = CameraPath::Kind;
  return {
      resolution(),
      boolean(
          "stereo.enabled", [](auto& s) -> auto& { return s.stereo.enabled; },
          "Two parallel views, the left one first."),
      onlyIf([](const PointSettings& s) { return s.stereo.enabled; },
             number(
                 "stereo.interpupillary_distance_mm",
                 [](auto& s) -> auto& { return s.stereo.interpupillaryDistanceMm; }, 0, 10000, "mm",
                 "Distance of the two eyes.")),
      number(
          "camera.fov_degrees", [](auto& s) -> auto& { return s.camera.verticalFovDegrees; }, 1, 170, "degrees",
          "Vertical field of view."),
      cameraDistance(),
      choice(
          "timeline.path", [](auto& s) -> auto& { return s.timeline.camera.kind; },
          std::vector<std::pair<std::string, Kind>>{
              {"orbit", Kind::orbit}, {"fixed", Kind::fixed}, {"keys", Kind::keys}},
          "How the camera moves."),
      onlyIf(onOrbit, number(
                          "timeline.revolutions", [](auto& s) -> auto& { return s.timeline.camera.revolutions; }, -1000,
                          1000, "", "Turns around the volume; negative: backwards.")),
      onlyIf(notOnKeys,
             number(
                 "timeline.elevation_degrees", [](auto& s) -> auto& { return s.timeline.camera.elevationDegrees; }, -90,
                 90, "degrees", "Of the camera above the plane of the orbit.")),
      onlyIf(notOnKeys, number(
                            "timeline.start_azimuth_degrees",
                            [](auto& s) -> auto& { return s.timeline.camera.startAzimuthDegrees; }, -36000, 36000,
                            "degrees", "About the scene's up axis, from its front.")),
      onlyIf(onKeys, cameraKeys()),
      isovalueSweep(),
      blend(),
      clippingPlanes(),
      boolean(
          "timeline.play_time_steps", [](auto& s) -> auto& { return s.timeline.playTimeSteps; },
          "All time steps once over the timeline."),
  };
}

} // namespace volmark
