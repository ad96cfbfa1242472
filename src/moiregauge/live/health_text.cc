// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/health_text.h"

#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

// Limits for clipped pixels and for the remaining modulation. They warn before rows become `saturated` or `blurred`
// (chosen).
constexpr double kClipped = 0.01;
constexpr double kModulation = 0.6;

}  // namespace

std::vector<std::string> health_hints(const LiveHealth& health) {
  std::vector<std::string> hints;
  constexpr double kPercent = 100.0;
  if (health.clipped > kClipped)
    hints.push_back(
        fmt::format("{:.0f} % of a marker's pixels are clipped: change the exposure", kPercent * health.clipped));
  if (health.modulation < kModulation)
    hints.push_back(
        fmt::format("a grating has {:.0f} % of its modulation: check focus and light", kPercent * health.modulation));
  if (health.rows > 0 && health.scenes == 0)
    hints.emplace_back("rows are not trusted before the first scene is solved");
  return hints;
}

std::string lost_text(const LostFrames& lost) {
  std::string reasons;
  for (const auto& [count, why] : {std::pair{lost.queue_full, "queue full"}, std::pair{lost.incomplete, "incomplete"},
                                   std::pair{lost.in_camera, "in the camera"},
                                   std::pair{lost.starting, "while the reference frame was learned"}}) {
    if (count > 0) reasons += fmt::format("{}{} {}", reasons.empty() ? "" : ", ", count, why);
  }
  return fmt::format("{} lost{}", lost.frames(), reasons.empty() ? "" : " (" + reasons + ")");
}

}  // namespace moiregauge::internal
