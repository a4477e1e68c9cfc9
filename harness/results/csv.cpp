#include "results/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace volmark {

namespace {

// The described names, then those that only the rows have.
template <typename Descriptors, typename Rows, typename NamesOf>
std::vector<std::string> namesIn(const Descriptors& descriptors, const Rows& rows, NamesOf namesOf) {
  std::vector<std::string> names;
  const auto add = [&names](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const auto& descriptor : descriptors)
    add(descriptor.name);
  for (const auto& row : rows)
    for (const auto& value : namesOf(row))
      add(value.name);
  return names;
}

// A pass may be recorded several times in a frame: its times add up.
std::optional<double> timeOf(const FrameRow& frame, const std::string& pass) {
  std::optional<double> sum;
  for (const PassTime& time : frame.passes)
    if (time.name == pass) sum = sum.value_or(0) + time.ms;
  return sum;
}

} // namespace

CsvText::CsvText(std::string_view name, const std::vector<std::string>& columns)
    : m_text(fmt::format("# volmark.{} 1\n", name)), m_columns(columns.size()) {
  for (const std::string& column : columns)
    text(column);
  endRow();
}

void CsvText::separate() {
  if (m_field++ > 0) m_text += ',';
}

CsvText& CsvText::text(std::string_view value) {
  separate();
  if (value.find_first_of(",\"\r\n") == std::string_view::npos) {
    m_text += value;
    return *this;
  }
  m_text += '"';
  for (char letter : value) {
    if (letter == '"') m_text += '"';
    m_text += letter;
  }
  m_text += '"';
  return *this;
}

CsvText& CsvText::number(double value) {
  separate();
  if (!std::isnan(value)) fmt::format_to(std::back_inserter(m_text), "{}", value);
  return *this;
}

CsvText& CsvText::number(std::optional<double> value) {
  return value ? number(*value) : empty();
}

CsvText& CsvText::integer(std::int64_t value) {
  separate();
  fmt::format_to(std::back_inserter(m_text), "{}", value);
  return *this;
}

CsvText& CsvText::integer(std::uint64_t value) {
  separate();
  fmt::format_to(std::back_inserter(m_text), "{}", value);
  return *this;
}

CsvText& CsvText::boolean(bool value) {
  return text(value ? "true" : "false");
}

CsvText& CsvText::empty() {
  separate();
  return *this;
}

void CsvText::endRow() {
  assert(m_field == m_columns);
  m_text += '\n';
  m_field = 0;
}

std::string nameOf(OrbitKind kind) {
  switch (kind) {
  case OrbitKind::warmUp: return "warm_up";
  case OrbitKind::headline: return "headline";
  case OrbitKind::breakdown: return "breakdown";
  }
  return "";
}

std::string framesCsv(std::span<const FrameRow> frames, const TechniqueInfo& info) {
  std::vector<std::string> columns{"orbit_kind", "orbit",     "frame",   "phase",    "host_ms", "interval_ms",
                                   "cpu_ms",     "update_ms", "draw_ms", "frame_ms", "gpu_ms",  "disturbed"};
  const auto passes = namesIn(info.passes, frames, [](const FrameRow& frame) { return std::span(frame.passes); });
  for (const std::string& pass : passes)
    columns.push_back("pass." + pass);

  CsvText csv("frames", columns);
  for (const FrameRow& frame : frames) {
    csv.text(nameOf(frame.orbitKind)).integer(std::int64_t{frame.orbit}).integer(std::int64_t{frame.frame});
    for (double value : {frame.phase, frame.hostMs, frame.intervalMs, frame.cpuMs, frame.updateMs, frame.drawMs,
                         frame.frameMs, frame.gpuMs})
      csv.number(value);
    csv.text(frame.disturbed);
    for (const std::string& pass : passes)
      csv.number(timeOf(frame, pass));
    csv.endRow();
  }
  return csv.str();
}

std::string countersCsv(std::span<const CounterRow> counters, const TechniqueInfo& info) {
  const auto names = namesIn(info.counters, counters, [](const CounterRow& row) { return std::span(row.values); });
  std::vector<std::string> columns{"frame", "phase"};
  columns.insert(columns.end(), names.begin(), names.end());

  CsvText csv("counters", columns);
  for (const CounterRow& row : counters) {
    csv.integer(std::int64_t{row.frame}).number(row.phase);
    for (const std::string& name : names) {
      const auto found = std::find_if(row.values.begin(), row.values.end(),
                                      [&name](const CounterValue& value) { return value.name == name; });
      if (found == row.values.end())
        csv.empty();
      else
        csv.integer(found->value);
    }
    csv.endRow();
  }
  return csv.str();
}

std::string picturesCsv(std::span<const PictureRow> pictures, const TechniqueInfo& info) {
  CsvText csv("pictures", {"frame", "phase", "view", "file", "reference", "reference_file", "mse", "psnr_db",
                           "identical", "ssim", "flip", "flip_hdr", "depth_mean_voxels", "depth_p995_voxels",
                           "depth_max_voxels", "missed_share", "spurious_share", "cumulative_ms"});
  for (const PictureRow& picture : pictures) {
    csv.integer(std::int64_t{picture.frame}).number(picture.phase).integer(std::int64_t{picture.view});
    csv.text(picture.file).text(picture.reference).text(picture.referenceFile);
    if (picture.reference == "none") {
      for (int column = 0; column < 11; ++column)
        csv.empty();
    } else {
      const PictureErrors& errors = picture.errors;
      csv.number(errors.mse).number(errors.psnrDb).boolean(errors.identical);
      csv.number(errors.ssim).number(errors.flip).number(errors.flipHdr);
      csv.number(errors.depthMeanVoxels).number(errors.depthP995Voxels).number(errors.depthMaxVoxels);
      csv.number(errors.missedShare).number(errors.spuriousShare);
    }
    csv.number(info.history == History::visible ? std::optional(picture.cumulativeMs) : std::nullopt);
    csv.endRow();
  }
  return csv.str();
}

} // namespace volmark
