// SPDX-License-Identifier: Apache-2.0
// Detects gratings in an image without prior knowledge: position, extent, axes, pitch in px and pattern.
#pragma once

#include <array>
#include <vector>

#include "moiregauge/image/image.h"
#include "moiregauge/site/site.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

struct GratingSearchOptions {
  int bits = 8;                 // per pixel
  double min_modulation = 8.0;  // grey levels of 8 bits, rms of the pattern
  double min_periods = 2.3;     // along both axes of the grating: sampling moire needs a window of 2 T - 1 px
  double min_explained = 0.8;   // share of the grey levels' variance that the lattice model explains
};

using ImageExtent = Extent<frame::Image>;

struct DetectedPatch {
  ImagePoint centre;                  // px
  std::array<ImagePoint, 4> outline;  // px, corners in order; a rectangle inside the grating, parallel to its axes
  // Wave vectors of the grating's axes in cycles (pitches) per px, at the centre and at the corners of the outline.
  // The x axis is the one nearest to the image's horizontal and points right, y points up. A line grating determines
  // only the vector along which its grey level varies.
  ImageExtent k_x, k_y;
  std::array<std::array<ImageExtent, 2>, 4> k_corners;
  double periods_x = 0.0;            // pitches, extent of the outline
  double periods_y = 0.0;            // pitches
  Pattern pattern = Pattern::kAuto;  // checkerboard, lines-x, lines-y, cosine; auto: any other crossed pattern
  bool dark_on_light = true;         // less than half of the area is dark
  double modulation = 0.0;           // grey levels of 8 bits, amplitude of the stronger fundamental
  double noise = 0.0;                // grey levels of 8 bits, rms residual: noise and harmonics beyond the series
};

// Detects all gratings, strongest modulation first. Gratings do not overlap.
[[nodiscard]] std::vector<DetectedPatch> find_grating_patches(const LumaView& luma,
                                                              const GratingSearchOptions& options);

// Returns true if p is inside the outline.
[[nodiscard]] bool holds(const DetectedPatch& patch, ImagePoint p);
// Returns the distance in px from p to the nearest point of the outline; 0 inside.
[[nodiscard]] double distance_px(const DetectedPatch& patch, ImagePoint p);

}  // namespace moiregauge::internal
