// SPDX-License-Identifier: Apache-2.0
// Tests the stated heights of targets (`z_mm`) against the footage they are used for.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "moiregauge/calibration/model/calibrate.h"

namespace moiregauge::internal {

// Returns the prior with the u of the targets' heights as if every `z_mm` were missing, about the stated heights.
[[nodiscard]] ScenePrior with_unknown_heights(Site site, ScenePrior prior);

// A stated height that the footage contradicts.
struct HeightContradiction {
  std::size_t marker = 0;
  double stated_mm = 0.0;
  double shown_mm = 0.0, u_shown_mm = 0.0;  // from the footage without the statement
  double pitch_mm = 0.0;                    // the pitch with which the target would look the same at the stated height
  double error_u = 0.0;                     // largest change of a displacement, in its u
};

// Tests the heights by a likelihood ratio: the fall of chi2 if they are unknown. Returns the most deviating target if the
// fall exceeds chance and a displacement changes by more than its u. A wrong height bends the focal length, so it also
// harms the other targets.
// `given`: prior with the heights as stated.
// `frames`: key frames, the reference frame first, as in `solved`.
// `u_size_mm`: error of each marker's depth that is the same in all frames, from the edges of its grating.
[[nodiscard]] std::optional<HeightContradiction> height_contradiction(const Site& site,
                                                                      std::span<const BundleFrame> frames,
                                                                      const ScenePrior& given,
                                                                      const Calibration& solved,
                                                                      std::span<const double> u_size_mm);

// Returns the warning. It names the height and the pitch, because apparent size cannot separate them.
[[nodiscard]] std::string height_contradiction_note(const Site& site, const HeightContradiction& found);

}  // namespace moiregauge::internal
