// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/common/json_progress.h"

#include <utility>

#include <fmt/format.h>

#include "moiregauge/app/provisional_samples.h"
#include "moiregauge/cli/common/interrupt.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal::cli {
namespace {

constexpr std::chrono::milliseconds kInterval(125);  // between two lines: eight a second

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

std::string view_line(const ProvisionalFrame& frame) {
  std::string map = "null";
  if (frame.reference_from_frame) {
    const Matrix3 rows = frame.reference_from_frame->matrix().transpose();  // Eigen stores columns
    map = fmt::format("[{:.9g}]", fmt::join(rows.data(), rows.data() + rows.size(), ","));
  }
  return fmt::format("{{\"type\":\"view\",\"frame\":{},\"reference_from_frame\":{}}}\n", frame.frame, map);
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
  if (samples == Samples::kProvisional) callbacks_.on_samples = [this](const ProvisionalFrame& frame) { keep(frame); };
}

JsonProgress::~JsonProgress() { write(); }

void JsonProgress::show(const RunProgress& progress) {
  latest_ = progress;
  if (stage_ == progress.stage && Clock::now() - written_ < kInterval) return;
  write();
}

void JsonProgress::keep(const ProvisionalFrame& frame) {
  for (const Sample& sample : frame.samples) rows_.keep(frame.site.markers[sample.marker].name, sample);
  view_ = view_line(frame);
}

void JsonProgress::write() {
  if (!latest_) return;
  const auto [stage, done, expected, waiting] = *latest_;
  print_note(fmt::format("{{\"type\":\"progress\",\"stage\":\"{}\",\"done\":{},\"expected\":{}}}\n", word_for(stage),
                         done, expected >= 0 ? std::to_string(expected) : "null"));
  print_note(rows_.take() + std::exchange(view_, ""));
  latest_.reset();
  stage_ = stage;
  written_ = Clock::now();
}

void add_progress(CLI::App& command, std::string& format) {
  command.add_option("--progress", format, "print the progress as JSON lines on stderr, for other programs")
      ->check(CLI::IsMember({"json"}).description(""))
      ->type_name("json");
}

}  // namespace moiregauge::internal::cli
