// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/common/sample_lines.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace moiregauge::internal::cli {
namespace {

constexpr std::size_t kMaxRows = 400;       // in one call
constexpr std::size_t kMaxKeptRows = 4000;  // without a call: of more, every second one
constexpr std::size_t kRowsOfLine = 40;

std::string row_number(double value) { return std::isfinite(value) ? fmt::format("{:.7g}", value) : "null"; }

}  // namespace

std::string json_text_of(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void SampleLines::keep(const std::string& marker, const Sample& sample) {
  if (rows_.size() >= kMaxKeptRows) {
    for (std::size_t i = 0; 2 * i < rows_.size(); ++i) std::swap(rows_[i], rows_[2 * i]);
    rows_.resize(rows_.size() / 2);
  }
  rows_.push_back({json_text_of(marker),
                   fmt::format("[{},{},{},{},{},{},{}]", sample.frame, row_number(sample.time_s),
                               row_number(sample.displacement.x), row_number(sample.displacement.y),
                               row_number(sample.u.x), row_number(sample.u.y), static_cast<int>(sample.status))});
}

std::string SampleLines::take() {
  std::vector<Row> rows = std::exchange(rows_, {});
  if (rows.size() > kMaxRows) {
    for (std::size_t i = 0; i < kMaxRows; ++i) std::swap(rows[i], rows[i * rows.size() / kMaxRows]);
    rows.resize(kMaxRows);
  }
  std::string text;
  for (std::size_t first = 0; first < rows.size(); first += kRowsOfLine) {
    const std::span line(rows.begin() + static_cast<std::ptrdiff_t>(first),
                         rows.begin() + static_cast<std::ptrdiff_t>(std::min(first + kRowsOfLine, rows.size())));
    std::ranges::stable_sort(line, {}, &Row::marker);
    text += "{\"type\":\"samples\",\"marker\":{";
    for (std::size_t i = 0; i < line.size(); ++i) {
      const bool is_same = i > 0 && line[i].marker == line[i - 1].marker;
      text += is_same ? "," : fmt::format("{}{}:[", i > 0 ? "]," : "", line[i].marker);
      text += line[i].values;
    }
    text += "]}}\n";
  }
  return text;
}

}  // namespace moiregauge::internal::cli
