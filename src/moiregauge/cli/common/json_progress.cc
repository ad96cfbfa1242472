// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/common/json_progress.h"

#include <fmt/format.h>

#include "moiregauge/cli/common/interrupt.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal::cli {
namespace {

constexpr std::chrono::milliseconds kInterval(100);  // between two lines: ten a second

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
  for (const Sample& sample : samples) rows_.keep(site.markers[sample.marker].name, sample);
}

void JsonProgress::write() {
  if (!latest_) return;
  const auto [stage, done, expected, waiting] = *latest_;
  print_note(fmt::format("{{\"type\":\"progress\",\"stage\":\"{}\",\"done\":{},\"expected\":{}}}\n", word_for(stage),
                         done, expected >= 0 ? std::to_string(expected) : "null"));
  print_note(rows_.take());
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
