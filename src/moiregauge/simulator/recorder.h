// SPDX-License-Identifier: Apache-2.0
// Renders a recording frame by frame, with the temporal processing of cameras.
#pragma once

#include <deque>
#include <optional>

#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::simulator {

// Returns true if a stored frame depends on earlier frames.
[[nodiscard]] bool has_temporal_steps(const Scenario& scenario);

// Applies averages over frames and recursive noise reduction to stored grey levels. Takes the frames in order, from the
// first one.
class TemporalFilter {
 public:
  explicit TemporalFilter(const Scenario& scenario);
  [[nodiscard]] Picture next(Picture picture);

 private:
  template <typename Grey>
  [[nodiscard]] Image<Grey> filtered(const Image<Grey>& now);

  Processing processing_;
  double grey_;  // stored grey levels per grey level of 8 bits
  std::deque<Picture> before_;
  std::optional<Image<double>> kept_;
};

// Renders the frames of a recording with the same result as `render`. Ascending frame numbers are fastest: an earlier
// number makes temporal processing start again at frame 0.
class Recorder {
 public:
  Recorder(const Scenario& scenario, const RenderOptions& options);
  [[nodiscard]] Picture frame(long number);

 private:
  const Scenario& scenario_;
  RenderOptions options_;
  TemporalFilter filter_;
  long next_ = 0;
};

}  // namespace moiregauge::internal::simulator
