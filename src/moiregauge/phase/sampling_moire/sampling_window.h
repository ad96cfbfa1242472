// SPDX-License-Identifier: Apache-2.0
// The window that linear interpolation between every T-th pixel amounts to, shared by the estimator and its
// uncertainty.
#pragma once

#include <cmath>
#include <complex>

#include "moiregauge/phase/sampling_moire/sampling_moire.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {

// Along the axis  h(u) = triangle(u) (exp(-2 pi i u / T) - leak),  across it  triangle(u),  |u| <= margin.
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
  double area = 0.0;  // sum of (T - |u|); T^2 for integer T
  // What a constant would leave behind. Zero for integer T, where T points make whole turns; a fractional T samples the
  // triangle unevenly and needs it taken off, or the lighting would move the grating.
  double leak = 0.0;
};

}  // namespace moiregauge::internal
