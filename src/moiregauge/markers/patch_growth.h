// SPDX-License-Identifier: Apache-2.0
// From a few periods about a seed to the whole print.
#pragma once

#include <optional>

#include "moiregauge/markers/lattice_fit.h"
#include "moiregauge/markers/lattice_seeds.h"
#include "moiregauge/site/site.h"

namespace moiregauge {

struct GrownPatch {
  LatticeModel model;
  Eigen::Matrix2d to_phi = Eigen::Matrix2d::Identity();  // print pitches -> phi
  PhiBox box;                                            // the print's extent in pitches
  Pattern pattern = Pattern::kAuto;
};

// Empty when what is at the seed is no print of at least `min_periods` pitches both ways, of which the series explains
// `min_explained` of the variance and which varies by `min_sigma` grey levels rms.
struct GrowthLimits {
  double min_periods = 0.0;
  double min_explained = 0.0;
  double min_sigma = 0.0;
};
[[nodiscard]] std::optional<GrownPatch> grow_patch(const Image<float>& grey, const LatticeSeed& seed,
                                                   const GrowthLimits& limits);

}  // namespace moiregauge
