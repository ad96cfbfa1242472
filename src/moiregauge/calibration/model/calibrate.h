// SPDX-License-Identifier: Apache-2.0
// Choosing how much of the scene the footage determines.
#pragma once

#include "moiregauge/calibration/model/print_error.h"
#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/calibration/scene/frame_fit.h"
#include "moiregauge/calibration/scene/frame_series.h"

namespace moiregauge::internal {

// A rolling shutter's signature: what noise alone does not explain, and how much of it would go if the camera might
// turn at a constant rate while the rows of each frame are read.
struct ShutterTest {
  double chi2_dof = 0.0;
  double share = 0.0;  // of chi2
  long dof = 0;
  bool suggests_rolling_shutter =
      false;  // for a solution with rows read one after the other: more than chance, and more than noise gives
};

struct Calibration {
  ScenePrior prior;            // as it was given, or wider where the prints are stretched more than it allows
  bool stretched = false;      // that they are
  BundleSolution bundle;       // of the model chosen, with its covariance
  std::vector<FrameFit> fits;  // of the bundle's frames against its scene
  PrintError print_error;      // added to the patches' noise; other frames need it too (with_print_error)
  ShutterTest shutter;
};

// Solves the models of the lens in ascending order (plane; + radial; + tangential), each from where the last one ended,
// and takes a larger one only when the full cost, data plus priors, falls by more than its parameters explain (Schwarz
// 1978: ln(rows) each). chi2 of the data alone would pass a flat model that bends a print scale to fit. Heights of the
// references and depths of the targets are always solved: their priors are the site's word, and all the price they pay.
// Prints stretched along one axis by more than three of the prior's u: which of their axes has the pitch that the site
// states cannot be seen, so the scales' priors are widened by half the stretch.
// until     when each of these solutions stops
[[nodiscard]] Calibration calibrate(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& prior,
                                    Until until = Until::kConverged);

// `most` of the frames, evenly spread in time with both ends, and up to twelve more: the extremes of the camera's pose.
// All of them where there are no more than `most`.
[[nodiscard]] std::vector<std::size_t> key_frames(std::span<const BundleFrame> frames, std::size_t most);
[[nodiscard]] std::vector<std::size_t> key_frames(std::span<const FrameStart> frames, std::size_t most);

}  // namespace moiregauge::internal
