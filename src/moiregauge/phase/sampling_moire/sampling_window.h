// SPDX-License-Identifier: Apache-2.0
// Window of the linear interpolation between every T-th pixel. The estimator and its uncertainty share it.
#pragma once

#include <cmath>
#include <complex>

#include "moiregauge/phase/sampling_moire/sampling_moire.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {

// Window along the axis (h) and across it (triangle), for |u| <= margin:
//     h(u) = triangle(u) (exp(-2 pi i u / T) - leak)
struct SamplingWindow {
  explicit SamplingWindow(double sampling_pitch_px)
      : pitch_px(sampling_pitch_px), margin(window_margin(sampling_pitch_px)) {
    for (int u = -margin; u <= margin; ++u) area += pitch_px - std::abs(u);
    if (is_integer()) return;
    for (int u = -margin; u <= margin; ++u) leak += triangle(u) * std::cos(kTwoPi * u / pitch_px);
  }

  [[nodiscard]] bool is_integer() const { return pitch_px == std::floor(pitch_px); }
  [[nodiscard]] double triangle(int u) const { return (pitch_px - std::abs(u)) / area; }
  [[nodiscard]] std::complex<double> along(int u) const {
    return triangle(u) * (std::polar(1.0, -kTwoPi * u / pitch_px) - leak);
  }

  double pitch_px;
  int margin;
  double area = 0.0;  // sum of (T - |u|), which is T^2 for integer T
  // Response of the triangle to a constant, which is subtracted. Otherwise a change of lighting would shift the phase.
  // It is zero for integer T, whose T points cover whole periods. A fractional T samples the triangle unevenly.
  double leak = 0.0;
};

}  // namespace moiregauge::internal
