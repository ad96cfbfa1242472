// SPDX-License-Identifier: Apache-2.0
// Noise of raster readings, from the readings themselves. u of a reading assumes independent pixels, with the noise that
// the finest detail shows. Behind a blur, an enlargement or a denoiser that detail is smooth, but coarser noise remains,
// which moves the phase.
//
// The slope of a grating's phase across its window shows that noise. Camera and target hardly change it from one frame
// to the next, because the view contains scale and perspective. For independent pixels its u follows from that of the
// mean phase. PatchReading::u_gradient is no measure here: it is an upper bound, 1.5 to 2.6 times larger.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "moiregauge/displacement/method.h"
#include "moiregauge/observation/reference/observations.h"
#include "moiregauge/planning/codec_error.h"

namespace moiregauge::internal {

// Compares the slopes of successive frames.
class ReadingNoise {
 public:
  // Keeps the latest `max_slopes` changes of a slope. `reference` must outlive this object.
  ReadingNoise(const Reference& reference, std::size_t max_slopes);

  // Adds a frame, which is compared with the one before.
  void add(const Observation& seen);
  // Forgets the frame before, so that the next one is compared with none.
  void forget_frame() { last_.assign(last_.size(), std::nullopt); }
  // Returns the ratio of the scatter of the slopes between successive frames to that of independent pixels. It is the
  // root of the median square, over gratings with two axes. 1 if it is below 1.2, or if fewer than 100 slopes show it.
  // Error: 1.2 / sqrt(n / 2) of the ratio for n slopes.
  [[nodiscard]] double excess() const;

 private:
  // Slopes of both axes along both axes, and u of the phases, of a grating that is read.
  struct Slopes {
    std::array<std::array<double, 2>, 2> gradient;
    std::array<double, 2> u_phase_rad;
  };
  void add_change(const Slopes& before, const Slopes& now, double slope_per_rad);

  std::vector<double> slope_per_rad_;  // one per site marker; 0: not used
  std::vector<std::optional<Slopes>> last_;
  std::vector<double> squares_;
  std::size_t next_ = 0, max_slopes_;
};

// Returns the excess that up to a thousand pairs of successive frames show, spread over the run.
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
