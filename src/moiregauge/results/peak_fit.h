// SPDX-License-Identifier: Apache-2.0
// Fits of sines and decays to a series, the strongest first. Each accepted fit is subtracted.
#pragma once

#include <vector>

#include "moiregauge/results/peaks.h"
#include "moiregauge/results/sine_fit.h"

namespace moiregauge::internal {

class PeakFits {
 public:
  PeakFits(const Series& series, const EvenTimes& times);

  // Fits a decay, then a steady sine, near a peak of `left()`. Returns true if one explains the peak. It is then
  // subtracted.
  bool take(double near_hz, double resolution_hz);
  [[nodiscard]] const Peak& last() const { return fits_.back().peak; }
  [[nodiscard]] const Series& left() const { return left_; }
  // Fits each again with all others subtracted, and updates it in `found`. `found`: all peaks, in the order of take(),
  // with others between.
  void refine(std::vector<Peak>& found);

 private:
  struct Window {  // rows of the series, including gaps
    std::size_t first = 0, count = 0;
  };
  struct Fit {
    SineFit sine;
    Peak peak;
    Window fitted, taken;  // a decay is subtracted from its impact, before the fitted rows
  };
  [[nodiscard]] Window falling_part(double omega) const;
  [[nodiscard]] Window from_impact(Window window, const SineFit& sine, double level) const;
  [[nodiscard]] bool try_fit(Window window, double omega, Decaying decaying);
  void add(const Fit& fit, double sign);

  const EvenTimes& times_;
  Series left_;
  Window all_;
  std::vector<Fit> fits_;
};

}  // namespace moiregauge::internal
