// Parts of a grid: combinations that are left out, and random samples of what remains.
#pragma once

#include "scenario/point.h"
#include "scenario/strict_json.h"

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace volmark {

/// A block's "exclude": [{"leaf": 2, "bits": [64, 128]}, ...]. An entry leaves out the combinations that have one of
/// its values, or labels of cases, on every axis that it names.
class Exclusions {
public:
  Exclusions() = default;
  /// Throws InputError for other shapes, and for axes that are not among `axes`. A value that an axis doesn't have
  /// leaves out nothing: a profile may have shortened the axis.
  Exclusions(const JsonValue& list, const std::set<std::string>& axes);

  /// `labels`: of one combination, by axis.
  bool leaveOut(const std::map<std::string, std::string>& labels) const;

private:
  std::vector<std::map<std::string, std::set<std::string>>> m_entries;
};

/// Shape alone, for documents whose axes aren't known yet. Throws InputError.
void checkExclusions(const JsonValue& list);

/// "sample": {"count": 200, "seed": 1}.
struct Sample {
  int count = 0;
  std::uint32_t seed = 1;
};
Sample readSample(const JsonValue& value);

/// Keeps `count` points at random, in their order and with new numbers. Which ones depends on their labels and the
/// seed alone: a grid that grows keeps most of its sample.
void keepSample(const Sample& sample, std::vector<Point>& points);

/// How an axis value is called.
std::string labelOfValue(const nlohmann::json& value);

} // namespace volmark
