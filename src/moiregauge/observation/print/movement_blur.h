// SPDX-License-Identifier: Apache-2.0
// Blur that grows with movement: it shows an average over time where a codec has removed the noise.
//
// A grating that moves by D px between frames is wider by a variance b D^2 along its movement. An exposure for the share
// e of the frame interval gives b = e^2 / 12, which is 1/12 at most. An average over frames gives the variance of its
// weights, in frames^2. That is 2/3 for three equal ones, and s / (1 - s)^2 for a share s of the last output.
//
//     variance_i = a + b D_i^2,     one a per grating and axis
//
// Focus and distance may blur all gratings of a frame together. So frames are independent, and gratings are not. u of b
// follows from the sums of the residuals over each frame.
//
// Source: tests/studies/averaged_study.py. Three equal frames behind a codec have b = 0.15 to 0.6, and without an
// average b is -0.1 to 0.04.
#pragma once

#include <cstddef>
#include <limits>
#include <span>

namespace moiregauge::internal {

// Blur of one grating along one axis, in one frame.
struct BlurReading {
  int frame = 0;
  std::size_t at = 0;     // number of the grating and axis
  double moved = 0.0;     // D, px
  double variance = 0.0;  // added since the reference frame, px^2
};

// Movement up to which the variance follows from the amplitude of the grating, pitches. Three equal images a sixth of a
// pitch apart leave 2/3 of it. Chosen.
inline constexpr double kLargestBlurred = 1.0 / 6.0;

struct BlurSlope {
  double slope = 0.0;  // b, frames^2
  double u = std::numeric_limits<double>::infinity();
};
// Returns b by all gratings. u is infinite if fewer than five frames determine it.
// Error: u is enlarged for few frames, so that 4 u are as rare as 4 sigma.
[[nodiscard]] BlurSlope blur_slope(std::span<const BlurReading> readings);

// Largest b of an exposure. D is a chord of the movement. So a vibration with N frames per period shows
// 1 / cos(2 pi / N) times as much, which is 2 for six frames.
inline constexpr double kBlurOfExposure = 2.0 / 12.0;

}  // namespace moiregauge::internal
