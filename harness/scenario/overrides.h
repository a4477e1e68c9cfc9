// What a "set" gives: values by dotted path, each with the place it was written at.
#pragma once

#include "scenario/strict_json.h"

#include <map>
#include <string>

namespace volmark {

/// One value given for a point key, or null: forget what was given before for the path and all below it.
struct Override {
  nlohmann::json value;
  std::string file;
  std::string pointer;

  JsonValue place() const { return JsonValue(value, file, pointer); }
};

/// By whole paths of point keys ("pacing.frames", "technique.parameters.step").
using Overrides = std::map<std::string, Override>;

/// Flattens an object whose keys may be nested or dotted. Every value is checked as far as its key alone allows.
/// Throws InputError: unknown key (with the nearest), wrong value, a path given twice.
Overrides readOverrides(const JsonValue& object);

/// `later` replaces and forgets in `base`.
void applyOverrides(const Overrides& later, Overrides& base);

/// `path` is `group` or lies below it.
bool isWithin(const std::string& path, const std::string& group);

} // namespace volmark
