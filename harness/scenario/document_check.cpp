#include "scenario/document_check.h"

#include "scenario/documents.h"
#include "scenario/overrides.h"
#include "scenario/selection.h"
#include "volmark/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace volmark {

namespace {

constexpr std::size_t kLongestName = 64;
constexpr std::int64_t kMostOfAnything = std::int64_t(1) << 40;

bool isNamePart(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

/// Names become folders and columns.
void checkName(const JsonValue& value, const std::string& name) {
  const bool good = !name.empty() && name.size() <= kLongestName && name.front() != '.' && name.front() != '-' &&
                    std::all_of(name.begin(), name.end(), isNamePart);
  if (!good)
    value.fail(fmt::format(
        "found name {}, allowed: 1 to {} of letters, digits, '_', '-' and '.', not beginning with '.' or '-'",
        shortJson(name), kLongestName));
}

/// A value that a patch takes away.
bool isRemoved(const JsonValue& value, bool isPatch) {
  return isPatch && value.json().is_null();
}

void checkCase(const JsonValue& value) {
  JsonObject object(value);
  const JsonValue label = object.at("label");
  const std::string text = label.text();
  if (text.size() > 200 ||
      std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }))
    label.refuse("one line of at most 200 characters");
  readOverrides(object.at("set"));
  object.refuseOthers();
}

void checkAxisValue(const JsonValue& value, const std::string& path) {
  const bool isCase = value.isObject() && value.json().contains("label");
  if (isCase) return checkCase(value);
  if (path.empty()) value.refuse("{\"label\", \"set\"}, because the axis has no \"path\"");
  const nlohmann::json set = {{path, value.json()}};
  try {
    readOverrides(JsonValue(set, ""));
  } catch (const InputError& error) {
    // The text begins with ": /path: ": the true place is the value's.
    std::string text = error.what();
    text.erase(0, text.find(": ", 2) + 2);
    value.fail(text);
  }
}

void checkAxis(const JsonValue& value, bool isPatch) {
  JsonObject object(value);
  std::string path;
  if (const auto given = object.find("path"); given && !isRemoved(*given, isPatch)) {
    path = given->text();
    const nlohmann::json set = {{path, nullptr}};
    readOverrides(JsonValue(set, given->file(), given->pointer()));
  }
  const auto values = object.find("values");
  object.refuseOthers();
  if (!values) {
    if (!isPatch) object.at("values");
    return;
  }
  if (isRemoved(*values, isPatch)) return;
  const std::vector<JsonValue> elements = values->array();
  if (elements.empty()) values->refuse("at least one value");
  // A patch may leave out the path that the file gives.
  if (isPatch && !object.has("path")) return;
  for (const JsonValue& element : elements)
    checkAxisValue(element, path);
}

void checkBlock(const JsonValue& value, bool isPatch) {
  JsonObject object(value);
  if (const auto set = object.find("set"); set && !isRemoved(*set, isPatch)) readOverrides(*set);
  if (const auto axes = object.find("axes"); axes && !isRemoved(*axes, isPatch)) {
    if (!axes->isObject()) axes->refuse("object");
    for (const auto& [name, ignored] : axes->json().items()) {
      checkName(*axes, name);
      if (name == "set") axes->fail("an axis can't be called \"set\"");
      if (const JsonValue axis = axes->member(name); !isRemoved(axis, isPatch)) checkAxis(axis, isPatch);
    }
  }
  if (const auto exclude = object.find("exclude"); exclude && !isRemoved(*exclude, isPatch)) checkExclusions(*exclude);
  object.refuseOthers();
}

void checkBlocks(const JsonValue& value, bool isPatch) {
  if (isPatch && value.isObject()) {
    for (const auto& [index, ignored] : value.json().items()) {
      if (index.empty() || index.size() > 6 ||
          !std::all_of(index.begin(), index.end(), [](char c) { return c >= '0' && c <= '9'; }))
        value.fail(fmt::format("unknown key {}, allowed: the number of a block, from 0", shortJson(index)));
      checkBlock(value.member(index), true);
    }
    return;
  }
  const std::vector<JsonValue> blocks = value.array();
  if (blocks.empty()) value.refuse("at least one block");
  for (const JsonValue& block : blocks)
    checkBlock(block, false);
}

void checkText(JsonObject& object, const std::string& key, bool isPatch) {
  if (const auto value = object.find(key); value && !isRemoved(*value, isPatch) && !value->json().is_string())
    value->refuse("text");
}

} // namespace

Limits readLimits(const JsonValue& value) {
  Limits limits;
  JsonObject object(value);
  const auto read = [&](const char* key, std::int64_t minimum, std::optional<std::int64_t>& limit) {
    if (const auto given = object.find(key); given && !given->json().is_null())
      limit = given->integer(minimum, kMostOfAnything);
  };
  read("pixels", 1, limits.pixels);
  read("voxels", 8, limits.voxels);
  read("frames", 1, limits.frames);
  object.refuseOthers();
  return limits;
}

void checkDocument(const JsonValue& document, DocumentKind kind) {
  const bool isPatch = kind != DocumentKind::file;
  JsonObject object(document);
  if (kind != DocumentKind::patch) {
    object.at("volmark").integer(1, 1);
    checkText(object, "$schema", false);
  }
  if (kind == DocumentKind::file) {
    const JsonValue name = object.at("name");
    checkName(name, name.text());
    if (const auto profiles = object.find("profiles")) {
      JsonObject byName(*profiles);
      for (const auto& [key, ignored] : profiles->json().items())
        checkDocument(profiles->member(key), DocumentKind::patch);
    }
  }
  checkText(object, "title", isPatch);
  checkText(object, "description", isPatch);
  if (const auto set = object.find("set"); set && !isRemoved(*set, isPatch)) readOverrides(*set);
  if (const auto limits = object.find("limits"); limits && !isRemoved(*limits, isPatch)) readLimits(*limits);
  if (const auto sample = object.find("sample"); sample && !isRemoved(*sample, isPatch) && !isPatch)
    readSample(*sample);
  if (const auto blocks = object.find("blocks"); blocks && !isRemoved(*blocks, isPatch)) checkBlocks(*blocks, isPatch);
  object.refuseOthers();
}

namespace {

using Ordered = nlohmann::ordered_json;

void flattenSet(Ordered& owner, const std::string& place) {
  const auto set = owner.find("set");
  if (set == owner.end() || !set->is_object()) return;
  const nlohmann::json plain = *set;
  Ordered flat = Ordered::object();
  for (const auto& [path, value] : readOverrides(JsonValue(plain, place)))
    flat[path] = value.value;
  *set = std::move(flat);
}

void flattenBlock(Ordered& block, const std::string& place) {
  if (!block.is_object()) return;
  flattenSet(block, place);
  const auto axes = block.find("axes");
  if (axes == block.end() || !axes->is_object()) return;
  for (auto& axis : *axes) {
    if (!axis.is_object() || !axis.contains("values") || !axis["values"].is_array()) continue;
    for (auto& value : axis["values"])
      if (value.is_object() && value.contains("label")) flattenSet(value, place);
  }
}

} // namespace

void flattenSets(nlohmann::ordered_json& document, const std::string& place) {
  flattenSet(document, place);
  if (const auto blocks = document.find("blocks"); blocks != document.end() && blocks->is_structured())
    for (auto& block : *blocks)
      flattenBlock(block, place);
  if (const auto profiles = document.find("profiles"); profiles != document.end() && profiles->is_object())
    for (auto& profile : *profiles)
      flattenSets(profile, place);
}

} // namespace volmark
