// SPDX-License-Identifier: Apache-2.0
// Noise of raster readings, from the readings themselves. u of a reading assumes independent pixels, with the noise that
// the finest detail shows. Behind a blur, an enlargement or a denoiser that detail is smooth, but coarser noise remains,
// which moves the phase.
//
// The slope of a grating's phase across its window shows that noise. Camera and target hardly change it from one frame
// to the next, because the view contains scale and perspective. For independent pixels its u follows from that of the
// mean phase. PatchReading::u_gradient is no measure here: it is an upper bound, 1.5 to 2.6 times larger.
#pragma once

#include "moiregauge/displacement/method.h"
#include "moiregauge/observation/reference/observations.h"
#include "moiregauge/planning/codec_error.h"

namespace moiregauge::internal {

// Returns the ratio of the scatter of the slopes between successive frames to that of independent pixels. It is the
// root of the median square, over gratings with two axes. 1 if it is below 1.2, or if fewer than 100 slopes show it.
// Error: 1.2 / sqrt(n / 2) of the ratio for n slopes.
[[nodiscard]] double noise_excess(const Reference& reference, const Observations& observations);

// Returns an observation whose readings have `excess` times the noise.
[[nodiscard]] Observation with_noise(Observation seen, double excess);

// Solution of a run whose readings have `excess` times the noise of independent pixels. That of the reference frame's
// readings in `reference` contains it already, that of the observations' readings does not.
using SolveInNoise = Solution (*)(const Reference& reference, const Observations& observations,
                                  const CodecHistory& codec, double excess);

// Solves with the noise that the readings show, and notes an excess. Behind a lossy codec there is none, because the
// codec's part of u covers all that it leaves in the readings.
[[nodiscard]] Solution solve_in_own_noise(const Reference& reference, const Observations& observations,
                                          SolveInNoise solve);

// Returns u of the slope of the phase across the window, relative to u of its mean, 1 / raster pixel, for independent
// pixels. Model: every pixel of the region is read with a triangle of half width T (seed paper, Eq. (2)).
[[nodiscard]] double slope_noise_per_mean(const RasterPlan& plan);

}  // namespace moiregauge::internal
