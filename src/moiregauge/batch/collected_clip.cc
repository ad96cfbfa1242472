// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/batch/collected_clip.h"

#include "moiregauge/base/control_characters.h"
#include "moiregauge/results/summary.h"

namespace moiregauge::internal {

Lamp lamp_of(const CollectedClip& clip) {
  if (!clip.is_finished()) return Lamp::kWaiting;
  switch (static_cast<Exit>(clip.state->exit_code)) {
    case Exit::kMeasured:
      return Lamp::kMeasured;
    case Exit::kIncomplete:
      return Lamp::kIncomplete;
    case Exit::kRefused:
      return Lamp::kRefused;
    default:
      return Lamp::kFailed;
  }
}

const char* word_for(Lamp lamp) {
  switch (lamp) {
    case Lamp::kMeasured:
      return "measured";
    case Lamp::kIncomplete:
      return "incomplete";
    case Lamp::kRefused:
      return "refused";
    case Lamp::kFailed:
      return "failed";
    case Lamp::kWaiting:
      return "waiting";
  }
  return "";
}

std::string one_line(const std::string& text) {
  std::string line;
  for (const char c : with_controls_escaped(text)) {
    if (c == '\n')
      line += "\\n";
    else if (c == '\t')
      line += "\\t";
    else
      line += c;
  }
  return line;
}

}  // namespace moiregauge::internal
