// The CSV files of a run: "# volmark.<name> 1", a header line, rows. Numbers keep all their digits, absent values
// are empty fields, fields with a comma, a quote or a line break are quoted.
#pragma once

#include "results/records.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace volmark {

class CsvText {
public:
  CsvText(std::string_view name, const std::vector<std::string>& columns);

  CsvText& text(std::string_view value);
  CsvText& number(double value); ///< NaN: empty; infinity: inf
  CsvText& number(std::optional<double> value);
  CsvText& integer(std::int64_t value);
  CsvText& integer(std::uint64_t value);
  CsvText& boolean(bool value); ///< true, false
  CsvText& empty();
  void endRow(); ///< asserts that every column has a field

  const std::string& str() const { return m_text; }

private:
  void separate();

  std::string m_text;
  std::size_t m_columns;
  std::size_t m_field = 0;
};

/// Columns pass.<name> stand in the order of `info`; passes that it doesn't know come last.
std::string framesCsv(std::span<const FrameRow> frames, const TechniqueInfo& info);
std::string countersCsv(std::span<const CounterRow> counters, const TechniqueInfo& info);
std::string picturesCsv(std::span<const PictureRow> pictures, const TechniqueInfo& info);

/// "warm_up", "headline", "breakdown".
std::string nameOf(OrbitKind kind);

} // namespace volmark
