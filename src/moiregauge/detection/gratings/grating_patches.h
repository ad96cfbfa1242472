// SPDX-License-Identifier: Apache-2.0
// Printed gratings in a picture of which nothing is known: where they are, how far they reach, along what they repeat.
#pragma once

#include <array>
#include <vector>

#include "moiregauge/image/image.h"
#include "moiregauge/site/site.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

struct GratingSearchOptions {
  int bits = 8;
  double min_modulation = 8.0;  // grey levels of 8 bits, rms of the pattern
  double min_periods = 2.3;     // along both of the print's axes: a reading needs the window of 2 T - 1 pixels
  double min_explained = 0.8;   // of the grey levels' variance, by a series on a lattice
};

using ImageExtent = Extent<frame::Image>;

struct DetectedPatch {
  ImagePoint centre;                  // px
  std::array<ImagePoint, 4> outline;  // px, in turn; a rectangle on the print that never reaches beyond it
  // The print's own axes, x nearest to the picture's horizontal (rightwards), y upwards. Cycles (pitches) per px at the
  // centre and at the four corners of the outline; of lines, only the one along which grey varies is true.
  ImageExtent k_x, k_y;
  std::array<std::array<ImageExtent, 2>, 4> k_corners;
  double periods_x = 0.0;  // the outline's extent in pitches
  double periods_y = 0.0;
  Pattern pattern = Pattern::kAuto;  // checkerboard, lines-x, lines-y, cosine; auto: any other crossed pattern
  bool dark_on_light = true;         // less than half is dark
  double modulation = 0.0;           // grey levels, amplitude of the stronger fundamental
  double noise = 0.0;                // grey levels, rms of what the series leaves: noise and sharp edges
};

// Strongest first.
[[nodiscard]] std::vector<DetectedPatch> find_grating_patches(const LumaView& luma,
                                                              const GratingSearchOptions& options);

[[nodiscard]] bool holds(const DetectedPatch& patch, ImagePoint p);
// px from p to the nearest point of the outline; 0 inside.
[[nodiscard]] double distance_px(const DetectedPatch& patch, ImagePoint p);

}  // namespace moiregauge::internal
