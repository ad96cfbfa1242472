// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/common/stage_display.h"

#include <fmt/format.h>

#include "moiregauge/cli/common/interrupt.h"
#include "moiregauge/cli/common/terminal_text.h"

namespace moiregauge::internal::cli {

StageDisplay::StageDisplay(bool quiet) : quiet_(quiet) {
  callbacks_.on_progress = [this](const RunProgress& progress) {
    show(progress);
    return !interrupted();
  };
  callbacks_.on_note = [this](const std::string& note) { print(note); };
}

void StageDisplay::show(const RunProgress& progress) {
  if (stage_ != progress.stage) {
    clear();
    stage_ = progress.stage;
    if (progress.stage == Stage::kSolving)
      elapsed_.emplace(fmt::format("solving {} frames", progress.expected), quiet_);
    else
      frames_.emplace(progress.stage == Stage::kMeasuring ? "measuring" : "drawing stabilised.mp4:", quiet_);
  }
  if (frames_) frames_->show(progress.done, progress.expected, progress.waiting_share);
}

void StageDisplay::clear() {
  frames_.reset();
  elapsed_.reset();
}

void StageDisplay::print(const std::string& note) {
  clear();
  stage_.reset();
  if (!quiet_) print_note(note + "\n");
}

}  // namespace moiregauge::internal::cli
