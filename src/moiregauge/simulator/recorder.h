// SPDX-License-Identifier: Apache-2.0
// A recording frame after frame: what cameras do to a picture with the help of the ones before it.
#pragma once

#include <deque>
#include <optional>

#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::simulator {

// True when a frame's stored picture depends on those before it.
[[nodiscard]] bool has_temporal_steps(const Scenario& scenario);

// Averages over frames and recursive noise reduction, of stored grey levels. Frames are given in order, from the first
// on.
class TemporalFilter {
 public:
  explicit TemporalFilter(const Scenario& scenario);
  [[nodiscard]] Picture next(Picture picture);

 private:
  template <typename Grey>
  [[nodiscard]] Image<Grey> filtered(const Image<Grey>& now);

  Processing processing_;
  double grey_;  // one grey level of 8 bits in stored ones
  std::deque<Picture> before_;
  std::optional<Image<double>> kept_;
};

// Gives the frames of a recording, as `render` does, and cheaply so when they are asked for in order.
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
