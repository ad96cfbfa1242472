// SPDX-License-Identifier: Apache-2.0
// Sampling moire (seed paper Eqs. (1)-(4)): the phase of a grating from one picture, by down-sampling at the sampling
// pitch T. T is close to, not necessarily equal to, the grating's pitch P in the picture.
// docs/methods/sampling-moire.md derives every line of it.
//
// Sign: a grating moved by +d px along the axis changes phi at a fixed pixel by -2 pi d / P (Eq. (4) solved for the
// phase).
#pragma once

#include <cmath>
#include <complex>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

enum class Axis { kX, kY };

inline constexpr double kMinSamplingPitchPx = 2.5;  // below it the fringe and its mirror image are one

// How far the window reaches to either side of its pixel, along and across: the triangle of Eq. (2) is zero from T on.
[[nodiscard]] inline int window_margin(double sampling_pitch_px) {
  return static_cast<int>(std::ceil(sampling_pitch_px)) - 1;
}

// The complex fringe at every pixel where the whole support of the window lies inside the picture:
//   z(x, y) ~ (a/2) G exp(i phi(x, y)), G = window_response(T, 1/P), 1 for P = T;
// phi the phase of Eq. (1) (NOT the moire phase: the carrier 2 pi x / T is added back), so that phi grows by 2 pi per
// pitch along the axis. Pixel (x, y) of the field is pixel (x + margin, y + margin) of the picture: T along the axis
// separates the grating, T across it averages the crossed one away.
// Empty when the picture is smaller than one window or T < kMinSamplingPitchPx. A NaN pixel makes the fringe NaN
// wherever a window holds it, and nowhere else.
struct FringeField {
  Image<std::complex<double>> fringe;
  int margin = 0;  // px on every side
  double sampling_pitch_px = 0.0;
};

// The textbook form, kept as the reference: T down-sampled pictures, linear interpolation, T-point DFT (Eqs. (2), (3))
// along `axis`, and their mean (the zero-frequency term of the same T points) across it. Integer T >= 3. O(T) per
// pixel.
[[nodiscard]] FringeField sampling_moire_textbook(ImageView<double> picture, Axis axis, int sampling_pitch_px);

// The production form: the same linear interpolation and DFT written as a windowed DFT (triangle of 2T - 1 taps for
// integer T) and evaluated in O(1) per pixel. Equal to the textbook form to 1e-12 of the fringe; accepts fractional T.
[[nodiscard]] FringeField sampling_moire(ImageView<double> picture, Axis axis, double sampling_pitch_px);

// Response of the window along the axis to exp(2 pi i f x), real by symmetry; exactly 0 for f = 0 (also for fractional
// T). A cosine of pitch P has its fringe at f = 1/P and its mirror term at f = -1/P, response sinc^2(1 + T/P) for long
// pitches.
[[nodiscard]] double window_response(double sampling_pitch_px, double cycles_per_px);

// The mean phase over a region (the paper's "average value over a 100x100 pixel area").
struct RegionPhase {
  double phase_rad = 0.0;   // at the region's centre: mean of phi minus the carrier 2 pi (s - s_centre) / P, wrapped
  double modulation = 0.0;  // mean amplitude a, grey levels, the window's response at 1/P taken out
  double background = 0.0;  // not filled by region_mean of a fringe field alone: 0
  double gradient_x_rad_per_px = 0.0;  // of phi minus carrier: least-squares plane over the region
  double gradient_y_rad_per_px = 0.0;
  double straightness_rad = 0.0;  // rms of phi minus carrier minus plane
  bool valid = false;             // false: modulation too low anywhere for the phase to be continued across the region
  double centre_x_px = 0.0;       // the region's centre in the picture the field was made of; half a pixel off the
  double centre_y_px = 0.0;       // picture's own centre when one side is odd and the other even
};

// The least local amplitude, as a part of the region's mean, that still carries the phase across: below it an edge, a
// shadow or an occluder is in the window, and noise of a tenth of the mean amplitude can add a whole turn.
inline constexpr double kMinRelativeModulation = 0.1;

// Grey levels. Below it the fringe is what rounding leaves of an evenly lit sheet (1e-13 of it), not light. Whether a
// modulation above it suffices against the camera's noise is for the caller to judge, by region_mean_uncertainty and
// the straightness.
inline constexpr double kMinModulation = 1e-6;

// Mean over the centred region of `region_px` x `region_px` (or the field's whole extent when smaller); the carrier is
// the pitch P along `axis`. Phase is continued from the centre outwards relative to that carrier, and must come out the
// same along every path.
[[nodiscard]] RegionPhase region_mean(const FringeField& field, Axis axis, double pitch_px, int region_px);

// How a grating is sampled.
struct Sampling {
  double sampling_pitch_px = 0.0;  // T
  double pitch_px = 0.0;           // P
  int region_px = 0;               // side of the region averaged; its support is region_px + 2 window_margin(T)
};

// sampling_moire and region_mean in one, of just the part of the picture that the centred region needs.
[[nodiscard]] RegionPhase measure_region(ImageView<double> picture, Axis axis, const Sampling& sampling);

// Cramer-Rao bound of the phase of a cosine of amplitude a in white noise sigma, over n pixels (Rife and Boorstyn
// 1974): u = (sigma / a) sqrt(2 / n), radians.
[[nodiscard]] double phase_bound(double noise_sigma, double modulation, double pixels);

// What region_mean itself reaches in white noise: its effective window w is region (x) triangle along and across, so
// u = (sigma / a) sqrt(2 sum |w|^2) / sum w, radians (first order in noise/modulation, mean over the phase). Exact for
// integer and fractional T.
[[nodiscard]] double region_mean_uncertainty(double noise_sigma, double modulation, double sampling_pitch_px,
                                             double pitch_px, int region_px);

}  // namespace moiregauge::internal
