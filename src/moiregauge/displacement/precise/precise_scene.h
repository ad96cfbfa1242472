// SPDX-License-Identifier: Apache-2.0
// The scene of one run, solved from its frames: who of the references moves, whether rows are read one after the other,
// what the prints miss.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/calibration/model/print_error.h"
#include "moiregauge/calibration/model/rolling_shutter.h"
#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

// Beyond this chi2 per degree of freedom, most of which goes when the camera may turn while rows are read, the shutter
// rolls.
inline constexpr double kRollingChi2 = 4.0;

struct PreciseScene {
  Calibration calibration;  // of the key frames, the reference frame first
  std::string problem;      // why the run cannot be measured in it
  bool rolls = false;  // rows are read one after the other, no path explains it: no row of any method is to be trusted

  FrameSeries frames;              // the footage in that scene: without a reference that moves, and set back
  std::optional<Shutter> shutter;  // that rolls, and was solved
  PrintError print_error;          // belongs in the covariance of `frames`

  bool references_verified = false;
  bool doubtful = false;             // one of the references moves, and it is not known which
  bool camera_contradicted = false;  // the camera that was given is not the one that filmed
  std::vector<std::string> notes;    // what the user should know
  std::string remedy;  // what to do where no row is trusted, as an order; empty where nothing is known to help
};

// read    the reference frame first, with the codec's error if there is one
// lossy   that there is one
[[nodiscard]] PreciseScene precise_scene(const Reference& reference, const FrameSeries& read, const ScenePrior& prior,
                                         const SolveOptions& options, bool lossy);

}  // namespace moiregauge::internal
