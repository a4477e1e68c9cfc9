#include "scenario/overrides.h"

#include "scenario/point_keys.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

namespace volmark {

namespace {

const PointKey* openGroupOf(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  if (dot == std::string::npos || dot + 1 == path.size()) return nullptr;
  const PointKey* group = findPointKey(path.substr(0, dot));
  return group && group->open ? group : nullptr;
}

/// Names that may follow `group` ("" for the first ones).
std::vector<std::string> namesWithin(const std::string& group) {
  const std::string prefix = group.empty() ? "" : group + ".";
  std::set<std::string> names;
  for (const PointKey& key : pointKeys())
    if (key.path.starts_with(prefix))
      names.insert(key.path.substr(prefix.size(), key.path.find('.', prefix.size()) - prefix.size()));
  return {names.begin(), names.end()};
}

bool isGroup(const std::string& path) {
  if (path.empty()) return false;
  const PointKey* key = findPointKey(path);
  return (key && key->open) || (!key && !namesWithin(path).empty());
}

/// Names the first part of a dotted path that isn't known.
[[noreturn]] void refuseUnknown(const JsonValue& parent, const std::string& key, const std::string& path) {
  std::string known;
  std::size_t begin = 0;
  for (std::size_t dot; (dot = path.find('.', begin)) != std::string::npos && isGroup(path.substr(0, dot));
       begin = dot + 1)
    known = path.substr(0, dot);
  const std::string wrong = path.substr(begin, path.find('.', begin) - begin);
  const std::string whole = known.empty() ? wrong : known + "." + wrong;
  if (findPointKey(whole))
    parent.fail(fmt::format("unknown key {}, allowed: \"{}\" as a whole", shortJson(key), whole));
  const std::vector<std::string> names = namesWithin(known);
  const std::string nearest = suggestion(wrong, names);
  const bool dotted = key.find('.') != std::string::npos;
  parent.fail(fmt::format("unknown key {}{} allowed{}: {}", shortJson(key), nearest.empty() ? "," : nearest,
                          dotted && !known.empty() ? fmt::format(" in {}", known) : "", fmt::join(names, ", ")));
}

class Flattening {
public:
  void visitMembers(const JsonValue& object, const std::string& prefix) {
    if (!object.isObject()) object.refuse("object");
    for (const auto& [key, ignored] : object.json().items())
      visit(object, key, prefix.empty() ? key : prefix + "." + key);
  }

  Overrides result;

private:
  void visit(const JsonValue& parent, const std::string& key, const std::string& path) {
    const JsonValue value = parent.member(key);
    const PointKey* leaf = findPointKey(path);
    if (!leaf || leaf->open) leaf = openGroupOf(path);
    if (!leaf && !isGroup(path)) refuseUnknown(parent, key, path);
    if (value.json().is_null())
      add(path, value);
    else if (leaf) {
      leaf->check(value);
      add(path, value);
    } else
      visitMembers(value, path);
  }

  void add(const std::string& path, const JsonValue& value) {
    if (!result.emplace(path, Override{value.json(), value.file(), value.pointer()}).second)
      value.fail(fmt::format("\"{}\" is given twice, once nested and once dotted", path));
  }
};

} // namespace

Overrides readOverrides(const JsonValue& object) {
  Flattening flattening;
  flattening.visitMembers(object, "");
  return std::move(flattening.result);
}

bool isWithin(const std::string& path, const std::string& group) {
  return path == group || path.starts_with(group + ".");
}

void applyOverrides(const Overrides& later, Overrides& base) {
  // Forget first: within one set, {"pacing": null, "pacing.frames": 3} starts afresh.
  for (const auto& entry : later) {
    if (!entry.second.value.is_null()) continue;
    std::erase_if(base, [&](const auto& known) { return isWithin(known.first, entry.first); });
  }
  for (const auto& [path, value] : later)
    if (!value.value.is_null()) base[path] = value;
}

} // namespace volmark
