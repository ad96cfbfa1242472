// SPDX-License-Identifier: Apache-2.0
// A quantity over time: straight lines between knots, plus a sine, plus random steps.
#pragma once

#include <cstdint>
#include <vector>

namespace moiregauge::internal::simulator {

struct Knot {
  double time_s = 0.0;
  double value = 0.0;
};

// Sum of an offset, the scaled knots (constant before the first and after the last), amplitude * sin(2 pi f t + phase)
// and a random step. A random step is uniform in -random..random. The middle of step n is at n * random_step_s.
struct Track {
  std::vector<Knot> knots{};  // ascending in time
  double scale = 1.0;
  double offset = 0.0;
  double amplitude = 0.0;
  double frequency_hz = 0.0;
  double phase_deg = 0.0;
  double random = 0.0;
  double random_step_s = 0.1;  // one frame at 10 fps
  std::uint64_t random_seed = 1;

  [[nodiscard]] double at(double time_s) const;
  // Returns the exact mean over [from_s, to_s], e.g. over an exposure.
  [[nodiscard]] double mean(double from_s, double to_s) const;
  [[nodiscard]] bool moves() const {
    return knots.size() > 1 || (amplitude != 0.0 && frequency_hz != 0.0) || random != 0.0;
  }
  // Returns an upper limit of the absolute value.
  [[nodiscard]] double limit() const;
  // Returns the times of kinks and steps between from_s and to_s.
  [[nodiscard]] std::vector<double> corners(double from_s, double to_s) const;
};

}  // namespace moiregauge::internal::simulator
