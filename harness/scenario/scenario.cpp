#include "scenario/scenario.h"

#include "scenario/documents.h"
#include "scenario/point_reading.h"
#include "scenario/selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace volmark {

namespace {

using Ordered = nlohmann::ordered_json;

constexpr std::size_t kMostPoints = 100000;

/// One value of an axis: what it is called and what it sets.
struct AxisValue {
  std::string label;
  Overrides overrides;
};

struct Axis {
  std::string name;
  std::vector<AxisValue> values;
};

AxisValue readAxisValue(const JsonValue& value, const std::string& path) {
  if (value.isObject() && value.json().contains("label"))
    return {value.member("label").text(), readOverrides(value.member("set"))};
  // Through the same reading as a set, so that an object stands for several paths; the place is the value's.
  const nlohmann::json set = {{path, value.json()}};
  AxisValue result{labelOfValue(value.json()), readOverrides(JsonValue(set, value.file()))};
  for (auto& [ignored, given] : result.overrides)
    given.pointer = value.pointer();
  return result;
}

Axis readAxis(const std::string& name, const JsonValue& value) {
  Axis axis{name, {}};
  const std::string path = value.json().value("path", "");
  for (const JsonValue& element : value.member("values").array())
    axis.values.push_back(readAxisValue(element, path));
  if (name != "technique") return axis;
  for (const AxisValue& one : axis.values)
    if (one.overrides.count("technique.name") == 0)
      value.fail("the axis \"technique\" is for technique.name; call this one otherwise");
  return axis;
}

/// The shape was checked; the order of the axes is the document's.
std::vector<Axis> readAxes(const Ordered& block, const JsonValue& place) {
  std::vector<Axis> axes;
  const auto found = block.find("axes");
  if (found == block.end()) return axes;
  const JsonValue all = place.member("axes");
  for (const auto& [name, ignored] : found->items())
    axes.push_back(readAxis(name, all.member(name)));
  return axes;
}

std::size_t combinationsOf(const std::vector<Axis>& axes, const JsonValue& place) {
  std::size_t count = 1;
  for (const Axis& axis : axes) {
    count *= axis.values.size();
    if (count > kMostPoints) place.fail(fmt::format("found over {0} points, allowed: {0}", kMostPoints));
  }
  return count;
}

class Expansion {
public:
  Expansion(const ScenarioOptions& options, const TechniqueCatalogue& techniques, const Limits& limits)
      : m_techniques(techniques), m_limits(limits), m_scenes(options.scenesFolder) {}

  /// `base`: the top level's set. `place` is the block.
  void addBlock(const Overrides& base, const Ordered& block, const JsonValue& place, int number) {
    Overrides common = base;
    if (place.json().contains("set")) applyOverrides(readOverrides(place.member("set")), common);
    const std::vector<Axis> axes = readAxes(block, place);
    for (const Axis& axis : axes)
      if (std::find(axisNames.begin(), axisNames.end(), axis.name) == axisNames.end()) axisNames.push_back(axis.name);
    const std::size_t count = combinationsOf(axes, place);
    if (points.size() + count > kMostPoints)
      place.fail(fmt::format("found over {0} points, allowed: {0}", kMostPoints));
    std::set<std::string> names;
    for (const Axis& axis : axes)
      names.insert(axis.name);
    const Exclusions exclusions =
        place.json().contains("exclude") ? Exclusions(place.member("exclude"), names) : Exclusions();
    for (std::size_t i = 0; i < count; ++i)
      addPoint(common, axes, i, exclusions, place, number);
  }

  std::vector<std::string> axisNames{"technique"};
  std::vector<Point> points;

private:
  /// `combination` counts with the last axis fastest.
  void addPoint(Overrides overrides, const std::vector<Axis>& axes, std::size_t combination,
                const Exclusions& exclusions, const JsonValue& place, int number) {
    std::vector<const AxisValue*> chosen(axes.size());
    for (std::size_t i = axes.size(); i-- > 0; combination /= axes[i].values.size())
      chosen[i] = &axes[i].values[combination % axes[i].values.size()];
    std::map<std::string, std::string> chosenLabels;
    for (std::size_t i = 0; i < axes.size(); ++i)
      chosenLabels[axes[i].name] = chosen[i]->label;
    if (exclusions.leaveOut(chosenLabels)) return;
    for (const AxisValue* value : chosen)
      applyOverrides(value->overrides, overrides);

    PointSettings settings = readSettings(overrides, place, m_techniques, m_scenes);
    applyLimits(m_limits, settings);
    Point point = pointOf(std::move(settings));
    for (std::size_t i = 0; i < axes.size(); ++i)
      if (axes[i].name != "technique") point.labels.push_back({axes[i].name, chosen[i]->label});
    point.index = static_cast<int>(points.size());
    point.block = number;
    refuseTwins(point, place);
    points.push_back(std::move(point));
  }

  /// Tables tell points apart by their labels alone.
  void refuseTwins(const Point& point, const JsonValue& place) {
    std::map<std::string, std::string> labels;
    for (const Label& label : point.labels)
      labels[label.axis] = label.value;
    const auto [first, isNew] = m_blockOfLabels.emplace(labels, point.block);
    if (isNew) return;
    std::string text;
    for (const auto& [axis, value] : labels)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", axis, value);
    place.fail(fmt::format("two points (blocks {} and {}) have the same labels: {}; an axis has to tell them apart",
                           first->second, point.block, text));
  }

  const TechniqueCatalogue& m_techniques;
  const Limits& m_limits;
  SceneLibrary m_scenes;
  std::map<std::map<std::string, std::string>, int> m_blockOfLabels;
};

} // namespace

Scenario readScenario(const ScenarioOptions& options, const TechniqueCatalogue& techniques) {
  const ScenarioDocument document = readDocument(options);
  Scenario scenario;
  scenario.document = document.json;
  scenario.name = scenario.document["name"];
  scenario.title = scenario.document.value("title", scenario.name);
  scenario.description = scenario.document.value("description", "");
  scenario.file = options.file;
  scenario.profile = options.profile;
  scenario.assignments = options.assignments;

  const JsonValue root(scenario.document, document.place);
  Limits limits;
  if (scenario.document.contains("limits")) limits = readLimits(root.member("limits"));
  Overrides base;
  if (scenario.document.contains("set")) applyOverrides(readOverrides(root.member("set")), base);

  Expansion expansion(options, techniques, limits);
  if (!document.json.contains("blocks")) {
    const nlohmann::json none = nlohmann::json::object();
    expansion.addBlock(base, Ordered::object(), JsonValue(none, document.place), 0);
  } else {
    const std::vector<JsonValue> blocks = root.member("blocks").array();
    for (std::size_t i = 0; i < blocks.size(); ++i)
      expansion.addBlock(base, document.json["blocks"][i], blocks[i], static_cast<int>(i));
  }
  scenario.axes = std::move(expansion.axisNames);
  scenario.points = std::move(expansion.points);
  if (scenario.points.empty()) root.fail("no point is left: \"exclude\" leaves out every combination");
  if (scenario.document.contains("sample")) keepSample(readSample(root.member("sample")), scenario.points);
  return scenario;
}

} // namespace volmark
