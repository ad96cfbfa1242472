// SPDX-License-Identifier: Apache-2.0
// Extends a lattice from a few periods around a seed to the whole grating.
#pragma once

#include <functional>

#include "moiregauge/detection/gratings/grating_fit.h"
#include "moiregauge/detection/gratings/grating_seeds.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

struct GrownPatch {
  LatticeModel model;
  Eigen::Matrix2d to_phi = Eigen::Matrix2d::Identity();  // phi from pitches along the grating's axes
  PhiBox box;                                            // extent of the grating in pitches
  Pattern pattern = Pattern::kAuto;
};

struct GrowthLimits {
  double min_periods = 0.0;               // along both axes of the grating
  double min_explained = 0.0;             // share of the variance that the series explains
  double min_sigma = 0.0;                 // grey levels, rms
  std::function<bool(ImagePoint)> taken;  // true for points on an accepted patch; a box that reaches one is dropped
};

enum class Growth { kPatch, kNoLattice, kTooSmall, kTaken };

// Result of the growth. `patch` is valid unless the outcome is kNoLattice: also if the box reached another patch
// (kTaken) or is below the limits (kTooSmall).
struct Grown {
  Growth outcome = Growth::kNoLattice;
  GrownPatch patch;
};

// Fits a lattice at the seed and extends its box by strips of 1 px while they match the model.
[[nodiscard]] Grown grow_patch(const Image<float>& grey, const LatticeSeed& seed, const GrowthLimits& limits);

// Returns the image smoothed with sigma = pitch / 6 (within a factor of 1.2), for a pitch in px.
using SmoothedPicture = std::function<const Image<float>&(double pitch_px)>;

// Grows a grid of thin lines on a smoothed copy of the image, where ragged edges and uneven ink do not stop the growth.
// The series and the lattice of the result are fitted to `grey` itself.
// Returns kNoLattice if the pattern is no grid of lines thinner than a third of the pitch.
[[nodiscard]] Grown grow_thin_lines(const Image<float>& grey, const SmoothedPicture& smoothed_for,
                                    const LatticeSeed& seed, const GrowthLimits& limits);

}  // namespace moiregauge::internal
