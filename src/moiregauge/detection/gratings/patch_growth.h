// SPDX-License-Identifier: Apache-2.0
// From a few periods about a seed to the whole print.
#pragma once

#include <functional>

#include "moiregauge/detection/gratings/grating_fit.h"
#include "moiregauge/detection/gratings/grating_seeds.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

struct GrownPatch {
  LatticeModel model;
  Eigen::Matrix2d to_phi = Eigen::Matrix2d::Identity();  // print pitches -> phi
  PhiBox box;                                            // the print's extent in pitches
  Pattern pattern = Pattern::kAuto;
};

struct GrowthLimits {
  double min_periods = 0.0;               // along both of the print's axes
  double min_explained = 0.0;             // of the variance, by the series
  double min_sigma = 0.0;                 // grey levels, rms
  std::function<bool(ImagePoint)> taken;  // by a patch that is known already: a box that comes there is given up
};

enum class Growth { kPatch, kNoLattice, kTooSmall, kTaken };

// `patch` is what there is at the seed; also when it ran into another (kTaken) or ended too soon (kTooSmall).
struct Grown {
  Growth outcome = Growth::kNoLattice;
  GrownPatch patch;
};
[[nodiscard]] Grown grow_patch(const Image<float>& grey, const LatticeSeed& seed, const GrowthLimits& limits);

// Grows a grid of thin lines on a smoothed copy of the picture: ragged edges and uneven ink end it nowhere there. The
// series and the lattice of the result are fitted to `grey` itself.
// Returns kNoLattice where the pattern is no grid of lines thinner than a third of the pitch.
// `smoothed_for`: the picture smoothed by sigma = pitch / 6 or so, of a pitch in px.
using SmoothedPicture = std::function<const Image<float>&(double pitch_px)>;
[[nodiscard]] Grown grow_thin_lines(const Image<float>& grey, const SmoothedPicture& smoothed_for,
                                    const LatticeSeed& seed, const GrowthLimits& limits);

}  // namespace moiregauge::internal
