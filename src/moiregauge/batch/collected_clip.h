// SPDX-License-Identifier: Apache-2.0
// One clip of a batch with its outcome, for table, catalogue and page.
#pragma once

#include <optional>
#include <string>

#include "moiregauge/batch/clip.h"
#include "moiregauge/batch/clip_state.h"
#include "moiregauge/batch/run_summary.h"

namespace moiregauge::internal {

struct CollectedClip {
  Clip clip;
  std::optional<ClipState> state;  // nothing: not measured so far
  std::optional<RunSummary> run;   // nothing: no results

  [[nodiscard]] bool is_finished() const { return state && state->is_finished; }
};

// kWaiting: not measured so far, or interrupted.
enum class Lamp { kMeasured, kIncomplete, kRefused, kFailed, kWaiting };

[[nodiscard]] Lamp lamp_of(const CollectedClip& clip);
[[nodiscard]] const char* word_for(Lamp lamp);

// Returns the text as valid UTF-8. Control characters and line ends are escaped.
[[nodiscard]] std::string one_line(const std::string& text);

}  // namespace moiregauge::internal
