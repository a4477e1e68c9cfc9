// run.json as a document (harness/README.md, Results).
#pragma once

#include "results/hash.h"
#include "results/records.h"
#include "scenario/point.h"
#include "technique/catalogue.h"

#include <nlohmann/json.hpp>

#include <optional>
#include <span>

namespace volmark {

inline constexpr int kFormatVersion = 1;

/// Over this the stamps of breakdown orbits slow the frames down: flagged.
inline constexpr double kStampsRatioLimit = 1.03;

nlohmann::ordered_json runDocument(const RunIdentity& identity, const Point& point, const CatalogueEntry& technique,
                                   const RunRecord& record);

/// The member "statistics". Needs at least one headline frame.
nlohmann::ordered_json statisticsDocument(std::span<const FrameRow> frames, const TechniqueInfo& info);

nlohmann::ordered_json labelsDocument(const std::vector<Label>& labels);

} // namespace volmark
