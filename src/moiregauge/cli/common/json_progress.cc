// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/common/json_progress.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/cli/common/interrupt.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/displacement/sample.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal::cli {
namespace {

constexpr std::chrono::milliseconds kInterval(100);  // between two lines: ten a second
constexpr std::size_t kMaxRows = 400;                // in one interval; of more, evenly spaced ones
constexpr std::size_t kRowsOfLine = 40;              // keeps a line below 4096 bytes

std::string json_text_of(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string row_number(double value) { return std::isfinite(value) ? fmt::format("{:.7g}", value) : "null"; }

const char* word_for(Stage stage) {
  switch (stage) {
    case Stage::kMeasuring:
      return "measuring";
    case Stage::kSolving:
      return "solving";
    case Stage::kDrawingVideo:
      return "drawing-video";
  }
  return "measuring";
}

}  // namespace

JsonProgress::JsonProgress(Samples samples) {
  callbacks_.on_progress = [this](const RunProgress& progress) {
    show(progress);
    return !interrupted();
  };
  callbacks_.on_note = [](const std::string& note) {
    print_note(fmt::format("{{\"type\":\"note\",\"text\":{}}}\n", json_text_of(note)));
  };
  if (samples == Samples::kProvisional)
    callbacks_.on_samples = [this](const Site& site, const std::vector<Sample>& all) { keep(site, all); };
}

JsonProgress::~JsonProgress() { write(); }

void JsonProgress::show(const RunProgress& progress) {
  latest_ = progress;
  if (stage_ == progress.stage && Clock::now() - written_ < kInterval) return;
  write();
}

void JsonProgress::keep(const Site& site, const std::vector<Sample>& samples) {
  for (const Sample& sample : samples) {
    rows_.push_back({json_text_of(site.markers[sample.marker].name),
                     fmt::format("[{},{},{},{},{},{},{}]", sample.frame, row_number(sample.time_s),
                                 row_number(sample.displacement.x), row_number(sample.displacement.y),
                                 row_number(sample.u.x), row_number(sample.u.y), static_cast<int>(sample.status))});
  }
}

// Writes rows of the same frame to the same line where they fit.
void JsonProgress::write_rows(std::size_t first, std::size_t end) {
  std::vector<Row> rows(rows_.begin() + static_cast<std::ptrdiff_t>(first),
                        rows_.begin() + static_cast<std::ptrdiff_t>(end));
  std::ranges::stable_sort(rows, {}, &Row::marker);
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool is_same = i > 0 && rows[i].marker == rows[i - 1].marker;
    text += is_same ? "," : fmt::format("{}{}:[", i > 0 ? "]," : "", rows[i].marker);
    text += rows[i].values;
  }
  print_note(fmt::format("{{\"type\":\"samples\",\"marker\":{{{}]}}}}\n", text));
}

void JsonProgress::write() {
  if (!latest_) return;
  const auto [stage, done, expected, waiting] = *latest_;
  print_note(fmt::format("{{\"type\":\"progress\",\"stage\":\"{}\",\"done\":{},\"expected\":{}}}\n", word_for(stage),
                         done, expected >= 0 ? std::to_string(expected) : "null"));
  if (rows_.size() > kMaxRows) {
    std::vector<Row> some;
    for (std::size_t i = 0; i < kMaxRows; ++i) some.push_back(std::move(rows_[i * rows_.size() / kMaxRows]));
    rows_ = std::move(some);
  }
  for (std::size_t i = 0; i < rows_.size(); i += kRowsOfLine) write_rows(i, std::min(i + kRowsOfLine, rows_.size()));
  rows_.clear();
  latest_.reset();
  stage_ = stage;
  written_ = Clock::now();
}

std::shared_ptr<std::string> add_progress(CLI::App& command) {
  auto format = std::make_shared<std::string>();
  command.add_option("--progress", *format, "print the progress as JSON lines on stderr, for other programs")
      ->check(CLI::IsMember({"json"}).description(""))
      ->type_name("json");
  return format;
}

}  // namespace moiregauge::internal::cli
