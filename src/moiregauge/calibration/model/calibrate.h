// SPDX-License-Identifier: Apache-2.0
// Calibration: selection of the scene model that the footage supports, with print error and marker jitter.
#pragma once

#include "moiregauge/calibration/model/print_error.h"
#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/calibration/scene/frame_fit.h"
#include "moiregauge/calibration/scene/frame_series.h"

namespace moiregauge::internal {

// Test for a rolling shutter. The camera may rotate at a changing rate while each frame's rows are read. The test
// states how much of chi2 that explains.
struct ShutterTest {
  double chi2_dof = 0.0;
  double share = 0.0;            // fraction of chi2 that rotation during readout explains
  double share_of_excess = 0.0;  // fraction of what exceeds noise, after rotation that noise explains
  long dof = 0;
  bool suggests_rolling_shutter = false;  // the fall exceeds chance and a quarter of the excess over noise
};

struct CalibrateOptions {
  Until until = Until::kConverged;  // stop criterion of each solution
  bool tilts = true;                // false: all prints are parallel to the plane
  bool print_error = true;          // false: without print error and covariance, for add_print_error
};

struct Calibration {
  ScenePrior prior;            // as given, or wider if the gratings are stretched beyond it
  bool stretched = false;      // the stretch exceeds 3 u, both of the given prior and of the solution
  BundleSolution bundle;       // for the selected model, with its covariance
  std::vector<FrameFit> fits;  // one per frame of the bundle
  PrintError print_error;      // added to the noise of the points; other frames need it, too (with_print_error)
  ShutterTest shutter;
};

// Selects the lens model by BIC (plane, + radial, + tangential). A larger model must lower the cost by ln(n) per
// parameter, for n residuals (Schwarz 1978). The cost includes the priors, because chi2 of the data alone would accept
// a flat model that bends a grating scale.
// Heights and depths are free within their priors. With a print error they must satisfy BIC, too.
// The priors of stretch and scales grow if the stretch exceeds 3 u of its prior. The reason is that images do not show
// which axis has the stated pitch.
// Tilts of the prints are solved if BIC accepts them, and if they explain more than a suspected rolling shutter.
// Fails (bundle.scene.solved = false): no lens model could be solved.
[[nodiscard]] Calibration calibrate(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& prior,
                                    const CalibrateOptions& options = {});

// Estimates the print error of a calibration that was made without it, and solves the scene again with it. Then computes
// the covariance. `given` and `until`: those of that calibration. The calibration must be solved.
void add_print_error(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& given, Until until,
                     Calibration& to);

// Returns the sorted indices of the key frames. These are `most` (at least 2) evenly spread frames with both ends, and
// up to twelve with the extremes of the pose. Returns all frames if there are no more than `most`.
[[nodiscard]] std::vector<std::size_t> key_frames(std::span<const BundleFrame> frames, std::size_t most);
[[nodiscard]] std::vector<std::size_t> key_frames(std::span<const FrameStart> frames, std::size_t most);

}  // namespace moiregauge::internal
