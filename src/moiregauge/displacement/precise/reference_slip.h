// SPDX-License-Identifier: Apache-2.0
// One reference against the others, if it alone may move: what the frames say of its way, and whether that way is a
// step. Linear about the scene solved with the reference taken for a target.
#pragma once

#include <optional>
#include <span>

#include "moiregauge/calibration/model/calibrate.h"

namespace moiregauge::internal {

struct ReferenceSlip {
  double chi2 = 0.0;       // that is left when the reference may go anywhere in every frame
  long dof = 0;            // of it
  double free_fall = 0.0;  // by which that is lower than if it stood still
  long free_rows = 0;      // for so many unknowns
  double step_fall = 0.0;  // by which one step, to stay, lowers it: two unknowns
  long first = 0;          // frame from which on it has slipped, if it has

  // chi2 that is left if the reference makes that step: of two that may have slipped the one that explains more has less.
  [[nodiscard]] double left() const { return chi2 + free_fall - step_fall; }
  // Variance of unit weight if the reference slips: 1 when noise is all there is, more when the scene does not hold or
  // what is left of the way after the step is more than noise.
  [[nodiscard]] double unit() const;
};

// The scene, lens and all, is solved anew from `start`; nothing where that fails. What `model` leaves out is yet
// allowed for, within its prior, in what the other references say of this one's place.
[[nodiscard]] std::optional<ReferenceSlip> fit_reference_step(Site site, std::span<const BundleFrame> frames,
                                                              ScenePrior prior, SceneModel model, const Scene& start,
                                                              std::size_t marker);

}  // namespace moiregauge::internal
