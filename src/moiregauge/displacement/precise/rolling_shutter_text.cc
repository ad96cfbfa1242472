// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/rolling_shutter_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace moiregauge::internal {
std::string shutter_note(const Scene& scene, bool given, double relative, double max_correction_mm,
                         const Samples& samples) {
  double worst = 0.0;
  long frame = 0;
  for (const Sample& s : samples) {
    const double left = std::max(s.budget.shutter.x, s.budget.shutter.y);
    if (s.status == Status::kOk && left > worst) worst = left, frame = s.frame;
  }
  const std::string over = std::isnan(scene.readout_s)
                               ? fmt::format("{:.2f} of the frame interval", std::abs(relative))
                               : fmt::format("{:.2f} ms, u {:.2f} ms{}", 1e3 * std::abs(scene.readout_s),
                                             1e3 * scene.u_readout_s, given ? ", with --readout" : "");
  // Only trusted rows count, so this part may be missing.
  const std::string left =
      worst > 0.0 ? fmt::format(". Its largest share of u is {:.4f} mm (frame {})", worst, frame) : "";
  return fmt::format("note: a rolling shutter was solved (readout time {}) and corrected, by up to {:.3f} mm{}", over,
                     max_correction_mm, left);
}

}  // namespace moiregauge::internal
