// What is made from all runs of an experiment.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace volmark {

/// The run.json of all runs under `experiment`/runs, by point index, replicate and hash; unfinished ones are left
/// out. Throws InputError for another format version.
std::vector<nlohmann::json> readRuns(const std::filesystem::path& experiment);

/// Throws InputError unless a run.json is of this program's format version.
void requireVersion(const nlohmann::json& run, const std::filesystem::path& file);

/// index.csv. Labels stand in the order of `axes`; axes that only older runs have come last.
std::string indexCsv(const std::vector<nlohmann::json>& runs, const std::vector<std::string>& axes);

/// google_benchmark.json: see harness/README.md, Results.
nlohmann::ordered_json googleBenchmark(const std::string& experiment, const std::vector<nlohmann::json>& runs,
                                       const std::vector<std::string>& axes);

/// The value at a JSON pointer, or nothing if a part of the way is missing, null or of another type.
std::string textAt(const nlohmann::json& document, const std::string& pointer); ///< "" for nothing
std::optional<double> numberAt(const nlohmann::json& document, const std::string& pointer);

/// The run's labels: `axes` first, in their order.
std::vector<std::string> axesOf(const nlohmann::json& run, const std::vector<std::string>& axes);

} // namespace volmark
