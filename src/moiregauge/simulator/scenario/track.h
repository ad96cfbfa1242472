// SPDX-License-Identifier: Apache-2.0
// One quantity over time: straight lines between knots, plus one sine, plus steps at random.
#pragma once

#include <cstdint>
#include <vector>

namespace moiregauge::internal::simulator {

struct Knot {
  double time_s = 0.0;
  double value = 0.0;
};

// offset + scale * (knots, held before the first and after the last) + amplitude * sin(2 pi f t + phase)
// + a value of -random .. random, drawn anew for every step; the middle of step n is at n * random_step_s.
struct Track {
  std::vector<Knot> knots{};  // rising in time
  double scale = 1.0;
  double offset = 0.0;
  double amplitude = 0.0;
  double frequency_hz = 0.0;
  double phase_deg = 0.0;
  double random = 0.0;
  double random_step_s = 0.1;  // one frame at 10 fps
  std::uint64_t random_seed = 1;

  [[nodiscard]] double at(double time_s) const;
  // The exact mean over [from_s, to_s], which is what an exposure sees.
  [[nodiscard]] double mean(double from_s, double to_s) const;
  [[nodiscard]] bool moves() const {
    return knots.size() > 1 || (amplitude != 0.0 && frequency_hz != 0.0) || random != 0.0;
  }
  // Where it bends or jumps within from_s..to_s.
  [[nodiscard]] std::vector<double> corners(double from_s, double to_s) const;
};

}  // namespace moiregauge::internal::simulator
