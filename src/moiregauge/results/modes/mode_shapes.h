// SPDX-License-Identifier: Apache-2.0
// Mode shapes: amplitude ratio and phase of every target and axis at a named peak, relative to the strongest one.
//
// All targets vibrate in one form of time at a peak, whatever it is (sine, decay or random). So the ratio of their
// spectral lines is the shape. With X_k(j) the lines of a Hann window over the common rows, from the peak's band,
//
//     R_k = sum_j conj(X_r(j)) X_k(j) / sum_j |X_r(j)|^2          r: the reference, the strongest
//
// (H1 estimator: Bendat and Piersol, Random Data, section 6.1). R_k is a weighted sum of the samples of k. Its error is
// the weighted sum of the error of k minus R_k times that of r.
#pragma once

#include <cstddef>
#include <vector>

#include "moiregauge/displacement/joint_errors.h"
#include "moiregauge/results/peaks.h"

namespace moiregauge::internal {

enum class BoardAxis { kX, kY };

// One axis of one target.
struct ModeEntry {
  std::size_t target = 0;  // index in the joint errors
  BoardAxis axis = BoardAxis::kX;
  double real = 0.0, imaginary = 0.0;         // parts of R
  double ratio = 0.0, u_ratio = 0.0;          // |R|: amplitude relative to the reference
  double phase_rad = 0.0, u_phase_rad = 0.0;  // -pi to pi; positive: ahead of the reference in time
};

struct ModeShape {
  Peak peak;                       // that of the reference
  std::size_t reference = 0;       // index in `entries`
  long rows = 0;                   // rows in which all entries are `ok`
  double resolution_hz = 0.0;      // another peak that is nearer than twice this is part of the shape
  std::vector<ModeEntry> entries;  // by target, then axis. The reference has R = 1 and u = 0
};

// Returns one shape per peak, by frequency. Peaks of several axes within the resolution are one.
// `samples`: by observation, then target, as the joint errors. `spectra`: in the order of the targets.
// An axis takes part if at least half of its rows are `ok`. The joint errors must know common errors.
// Fails (no shapes): no peak has a name, or fewer than kMinSamples rows are common.
// Error: u holds noise and shared factors by the joint errors. Where the record is noisier near the peak than they
// state, the excess is added as noise that is independent between axes. The reference's own noise biases R by the
// inverse of its signal-to-noise power ratio in the band, which is below u.
[[nodiscard]] std::vector<ModeShape> mode_shapes(const Samples& samples, const JointErrors& joint,
                                                 const std::vector<TargetSpectra>& spectra);

}  // namespace moiregauge::internal
