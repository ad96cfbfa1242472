// SPDX-License-Identifier: Apache-2.0
// Path of one reference against the others, and its largest step. Linear about the scene that is solved with this
// reference as a target.
#pragma once

#include <optional>
#include <span>

#include "moiregauge/calibration/model/calibrate.h"

namespace moiregauge::internal {

// Place of a step among the frames that were tested.
struct StepPlace {
  long before = 0;   // last frame at the old position
  long settled = 0;  // first frame at the new position
};

struct ReferenceSlip {
  double chi2 = 0.0;       // chi2 of the scene in which this reference moves freely
  long dof = 0;            // degrees of freedom of chi2
  double free_fall = 0.0;  // chi2 of its positions about one constant position
  long free_rows = 0;      // number of unknowns of the free path
  double step_fall = 0.0;  // fall of that chi2 by one lasting step (two unknowns)
  StepPlace step;
  // Mean square change of the path from frame to frame, in units of what independent positions give: 1. A path that
  // creeps evenly over n frames has 6 / n^2.
  double roughness = 1.0;

  // Returns false if the path is no step: it is smooth, and a separate position in each frame explains more. Each costs
  // 40 in chi2. Haze moves all references independently, so their paths are not smooth.
  [[nodiscard]] bool is_step() const;
  // Returns chi2 after the step or the free path. Among several references, the one that explains more leaves less.
  [[nodiscard]] double left() const;
  // Returns the fall of chi2 by the step or the free path.
  [[nodiscard]] double fall() const { return chi2 + free_fall - left(); }
  // Returns the variance of unit weight, at least 1. It exceeds 1 if the scene does not hold, or if the path after the
  // step exceeds noise.
  [[nodiscard]] double unit() const;
};

// Fits the path of one reference, and its largest step. The scene with its lens is solved again from `start`.
// Parameters outside the model of `start` remain uncertain within their priors.
// Fails (nothing): the scene is not solved, or fewer than two frames show the reference.
[[nodiscard]] std::optional<ReferenceSlip> fit_reference_step(Site site, std::span<const BundleFrame> frames,
                                                              ScenePrior prior, const Scene& start, std::size_t marker);

}  // namespace moiregauge::internal
