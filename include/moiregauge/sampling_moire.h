// SPDX-License-Identifier: Apache-2.0
// Phase of one grating in one image, by sampling moiré (Eqs. (1) to (4) of the paper). docs/methods/sampling-moire.md.
// It needs no other part of the library: link moiregauge::sampling_moire.
#pragma once

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

// Returns the displacement along the axis between two phases of the same region in px, within half a pitch.
[[nodiscard]] MOIREGAUGE_API double displacement_px(const FringePhase& reference, const FringePhase& current,
                                                    double pitch_px);

}  // namespace moiregauge
