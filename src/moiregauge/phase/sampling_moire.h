// SPDX-License-Identifier: Apache-2.0
// Sampling moire (seed paper Eqs. (1)-(4)): the phase of a grating from one picture, by down-sampling at the sampling
// pitch T. T is close to, not necessarily equal to, the grating's pitch P in the picture.
#pragma once

#include <complex>
#include <vector>

#include "moiregauge/image/image.h"

namespace moiregauge {

enum class Axis { kX, kY };

// The complex fringe at every pixel where the whole support of the window lies inside the picture:
//   z(x, y) ~ (a/2) exp(i phi(x, y)), phi the phase of Eq. (1) (NOT the moire phase: carrier 2 pi x / T is added back),
// so that phi grows by 2 pi per pitch along the axis. Pixel (x, y) of the field is pixel (x + margin, y + margin) of the
// picture, margin = ceil(T) - 1 (+1 for a fractional T) on every side: T along the axis separates the grating, T across it
// averages the crossed one away.
struct FringeField {
  Image<std::complex<double>> fringe;
  int margin = 0;  // px on every side
};

// The textbook form, kept as the reference: T down-sampled pictures, linear interpolation, T-point DFT (Eqs. (2), (3)) along
// `axis`, and their mean (the zero-frequency term of the same T points) across it. Integer T only. O(T) per pixel.
[[nodiscard]] FringeField sampling_moire_textbook(ImageView<double> picture, Axis axis, int sampling_pitch_px);

// The production form: the same linear interpolation and DFT written as a windowed DFT (triangle of 2T - 1 taps for integer
// T) and evaluated in O(1) per pixel. Equal to the textbook form to 1e-12 of the fringe; accepts fractional T >= 2.5.
[[nodiscard]] FringeField sampling_moire(ImageView<double> picture, Axis axis, double sampling_pitch_px);

// The mean phase over a region (the paper's "average value over a 100x100 pixel area").
struct RegionPhase {
  double phase_rad = 0.0;            // at the region's centre: mean of phi minus the carrier 2 pi (s - s_centre) / P, wrapped
  double modulation = 0.0;           // mean amplitude a, grey levels
  double background = 0.0;           // not filled by region_mean of a fringe field alone: 0
  double gradient_x_rad_per_px = 0.0;// of phi minus carrier: least-squares plane over the region
  double gradient_y_rad_per_px = 0.0;
  double straightness_rad = 0.0;     // rms of phi minus carrier minus plane
  bool valid = false;                // false: modulation too low anywhere for the phase to be continued across the region
};

// Mean over the centred region of `region_px` x `region_px` (or the field's whole extent when smaller); the carrier is the
// pitch P along `axis`. Phase is continued from the centre outwards relative to that carrier.
[[nodiscard]] RegionPhase region_mean(const FringeField& field, Axis axis, double pitch_px, int region_px);

// Cramer-Rao bound of the phase of a cosine of amplitude a in white noise sigma, over n pixels (Rife and Boorstyn 1974):
// u = (sigma / a) sqrt(2 / n), radians.
[[nodiscard]] double phase_bound(double noise_sigma, double modulation, double pixels);

// What region_mean itself reaches in white noise: its effective window is region (x) triangle along and across, so
// u = (sigma / a) sqrt(2 sum w^2) / sum w, radians (first order in noise/modulation). Exact for integer and fractional T.
[[nodiscard]] double region_mean_uncertainty(double noise_sigma, double modulation, double sampling_pitch_px, double pitch_px,
                                             int region_px);

}  // namespace moiregauge
