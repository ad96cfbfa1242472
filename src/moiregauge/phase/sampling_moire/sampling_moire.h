// SPDX-License-Identifier: Apache-2.0
// Sampling moiré (seed paper Eqs. (1) to (4)): the phase of a grating from one image, by down-sampling at the sampling
// pitch T. T is near the grating's pitch P in the image, but need not equal it. docs/methods/sampling-moire.md derives
// every step.
//
// Sign: moving a grating by +d px along the axis changes phi at a fixed pixel by -2 pi d / P (Eq. (4) solved for the
// phase).
#pragma once

#include <cmath>
#include <complex>
#include <limits>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

enum class Axis { kX, kY };

// px. Below it the window cannot separate the fringe from its mirror term. Chosen.
inline constexpr double kMinSamplingPitchPx = 2.5;

// Returns the reach of the window to either side of its pixel, along and across, px. The triangle of Eq. (2) is zero
// from T on.
[[nodiscard]] inline int window_margin(double sampling_pitch_px) {
  return static_cast<int>(std::ceil(sampling_pitch_px)) - 1;
}

// Complex fringe at every pixel whose window is inside the image, with G = window_response(T, 1/P), 1 for P = T:
//     z(x, y) ~ (a/2) G exp(i phi(x, y))
// phi is the phase of Eq. (1) and not that of the moiré, because the carrier 2 pi x / T is added back. It grows by 2 pi
// per pitch along the axis. Pixel (x, y) of the field is pixel (x + margin, y + margin) of the image. T along the axis
// separates the grating. T across it suppresses the crossed grating.
// The field is empty if the image is smaller than one window or T < kMinSamplingPitchPx. A NaN pixel makes the fringe
// NaN in every window that contains it, and nowhere else.
struct FringeField {
  Image<std::complex<double>> fringe;
  int margin = 0;  // px on every side
  double sampling_pitch_px = 0.0;
};

// Returns the fringe by the textbook form, which tests use as the reference. Along `axis`: T down-sampled images,
// linear interpolation and a T-point DFT (Eqs. (2), (3)). Across it: their mean, the zero-frequency term of the same T
// points. It requires an integer T >= 3 and costs O(T) per pixel.
[[nodiscard]] FringeField sampling_moire_textbook(ImageView<double> picture, Axis axis, int sampling_pitch_px);

// Returns the fringe by a windowed DFT, which is the same linear interpolation and DFT in O(1) per pixel. The window is
// a triangle of 2T - 1 taps for integer T. T may be fractional.
// Error: the difference from the textbook form is below 1e-12 of the fringe.
[[nodiscard]] FringeField sampling_moire(ImageView<double> picture, Axis axis, double sampling_pitch_px);

// Returns the window's response along the axis to exp(2 pi i f x), real by symmetry. It is 0 for f = 0, also for
// fractional T. A cosine of pitch P has its fringe at f = 1/P and its mirror term at f = -1/P. For long pitches the
// response to the mirror term is sinc^2(1 + T/P).
[[nodiscard]] double window_response(double sampling_pitch_px, double cycles_per_px);

// Mean phase over a region (the paper's "average value over a 100x100 pixel area").
struct RegionPhase {
  // Phase at the region's centre: mean of phi minus the carrier 2 pi (s - s_centre) / P, wrapped.
  double phase_rad = 0.0;
  // Mean amplitude a, grey levels, corrected for the window's response at 1/P.
  double modulation = 0.0;
  // Slopes of phi minus carrier, by a least-squares plane over the region.
  double gradient_x_rad_per_px = 0.0;
  double gradient_y_rad_per_px = 0.0;
  double straightness_rad = 0.0;  // rms of phi minus carrier minus plane
  // False if the modulation is too low somewhere, or if the phase depends on the path from the centre.
  bool valid = false;
  // Centre of the region in the image of the field. It is half a pixel off the centre of the image if one side is odd
  // and the other even.
  double centre_x_px = 0.0;
  double centre_y_px = 0.0;
};

// Smallest local amplitude, relative to the region's mean, that carries the phase across. Below it an edge, a shadow or
// an occlusion is in the window. Noise of a tenth of the mean amplitude can then add a whole period. Chosen.
inline constexpr double kMinRelativeModulation = 0.1;

// Grey levels. A smaller modulation is the rounding of an evenly lit sheet (1e-13 of its level). Callers compare a
// larger one with the camera's noise, by region_mean_uncertainty and the straightness. Chosen.
inline constexpr double kMinModulation = 1e-6;

// Pitch of a field whose carrier is removed and whose window has the response 1.
inline constexpr double kNoCarrier = std::numeric_limits<double>::infinity();

// Returns the mean phase over the centred region of `region_px` x `region_px`, or over the whole field if it is
// smaller. The carrier has the pitch P along `axis`. The phase is unwrapped from the centre outwards, relative to that
// carrier.
// Fails (valid = false): the modulation is too low, or the phase depends on the path.
// Error: region_mean_uncertainty.
[[nodiscard]] RegionPhase region_mean(const FringeField& field, Axis axis, double pitch_px, int region_px);

// Sampling of a grating.
struct Sampling {
  double sampling_pitch_px = 0.0;  // T
  double pitch_px = 0.0;           // P
  // Side of the averaged region. Its support is region_px + 2 window_margin(T).
  int region_px = 0;
};

// Returns region_mean of sampling_moire, from the part of the image that the centred region needs.
[[nodiscard]] RegionPhase measure_region(ImageView<double> picture, Axis axis, const Sampling& sampling);

// Returns the Cramér-Rao bound of a cosine's phase in white noise, over n pixels: u = (sigma / a) sqrt(2 / n), rad
// (Rife and Boorstyn 1974).
[[nodiscard]] double phase_bound(double noise_sigma, double modulation, double pixels);

// Returns the standard uncertainty of region_mean's phase in white noise: u = (sigma / a) sqrt(2 sum |w|^2) / sum w,
// rad. The effective window w is region (x) triangle, along and across. The formula is exact for integer and fractional
// T. It is the first order in noise / modulation, averaged over the phase of the grating.
[[nodiscard]] double region_mean_uncertainty(double noise_sigma, double modulation, double sampling_pitch_px,
                                             double pitch_px, int region_px);

}  // namespace moiregauge::internal
