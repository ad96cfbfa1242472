// SPDX-License-Identifier: Apache-2.0
// Progress of a run, and the means to stop it. Command line, library and Python each show it in their own way.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace moiregauge::internal {

struct ProvisionalFrame;

enum class Stage { kMeasuring, kSolving, kDrawingVideo };

struct RunProgress {
  Stage stage = Stage::kMeasuring;
  long done = 0;                        // frames
  long expected = -1;                   // frames; -1: unknown
  std::optional<double> waiting_share;  // share of the time spent waiting for frames; empty: unknown
};

// Each may be empty.
struct RunCallbacks {
  std::function<bool(const RunProgress&)> on_progress;  // called after each frame; false stops the run, resumable
  std::function<void(const std::string&)> on_note;      // a line for the user, without its end
  // Receives provisional samples of a frame while it is measured, before its on_progress.
  std::function<void(const ProvisionalFrame&)> on_samples{};

  [[nodiscard]] bool may_continue(const RunProgress& progress) const { return !on_progress || on_progress(progress); }
  void note(const std::string& line) const {
    if (on_note) on_note(line);
  }
};

}  // namespace moiregauge::internal
