// SPDX-License-Identifier: Apache-2.0
// Phase of one grating in one image, by sampling moiré (Eqs. (1) to (4) of the paper). docs/methods/sampling-moire.md.
// It needs no other part of the library: link moiregauge::sampling_moire.
#pragma once

#include <vector>

#include "moiregauge/errors.h"
#include "moiregauge/image.h"

namespace moiregauge {

enum class Axis { kX, kY };

struct FringePhase {
  double phase_rad = 0.0;   // at the centre of the region, in [-pi, pi]
  double u_rad = 0.0;       // standard uncertainty (k = 1) from white noise of `noise_grey`
  double modulation = 0.0;  // mean amplitude, grey levels
  bool is_valid = false;    // false: too little modulation, or the phase depends on the path
};

// Returns the mean phase of a grating over the centred region of `region_px` x `region_px` pixels.
// Model: grey = b + a cos(2 pi x / pitch_px + phase), down-sampled at round(pitch_px). `noise_grey`: noise of a pixel.
// A grating that moves by +d px along the axis changes the phase by -2 pi d / pitch_px.
// Fails (is_valid = false): see FringePhase.
// Error: u_rad; harmonics of a binary grating cancel over whole pitches.
[[nodiscard]] MOIREGAUGE_API FringePhase sampling_moire(const ImageView& image, Axis axis, double pitch_px,
                                                        int region_px, double noise_grey);

// Phase at every pixel whose window is inside the image. Pixel (x, y) of the map is pixel (x + margin, y + margin) of the
// image, and element y * width + x of the vectors.
struct PhaseMap {
  int width = 0, height = 0;       // px; 0: the image is smaller than a window
  int margin = 0;                  // px on every side
  std::vector<double> phase_rad;   // phase of Eq. (1), in [-pi, pi]
  std::vector<double> modulation;  // amplitude, grey levels
};

// Returns the phase of a grating pixel by pixel, which grows by 2 pi per pitch along the axis.
// Model: as sampling_moire. The map is empty if pitch_px is below 2.5.
// Error: neighbours share their window of 2 pitch_px - 1 pixels, so their errors are correlated.
[[nodiscard]] MOIREGAUGE_API PhaseMap phase_map(const ImageView& image, Axis axis, double pitch_px);

// Returns the displacement along the axis between two phases of the same region in px, within half a pitch.
[[nodiscard]] MOIREGAUGE_API double displacement_px(const FringePhase& reference, const FringePhase& current,
                                                    double pitch_px);

}  // namespace moiregauge
