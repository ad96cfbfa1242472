// SPDX-License-Identifier: Apache-2.0
// Sines and decays taken out of a series one after the other, the strongest first.
#pragma once

#include <vector>

#include "moiregauge/results/peaks.h"
#include "moiregauge/results/sine_fit.h"

namespace moiregauge::internal {

class PeakFits {
 public:
  PeakFits(const Series& series, const EvenTimes& times);

  // Tries a decay, then a steady sine, near a peak of `left()`. True: it explains the peak, and is taken out.
  bool take(double near_hz, double resolution_hz);
  [[nodiscard]] const Peak& last() const { return fits_.back().peak; }
  [[nodiscard]] const Series& left() const { return left_; }
  // Each once more with all others taken out; `found`: the peaks as they were, in the order of take(), others between.
  void refine(std::vector<Peak>& found);

 private:
  struct Window {  // rows of the series, gaps included
    std::size_t first = 0, count = 0;
  };
  struct Fit {
    SineFit sine;
    Peak peak;
    Window fitted, taken;  // a decay is taken out from the blow on, which its fit leaves to others
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
