// SPDX-License-Identifier: Apache-2.0
// Circular markers in a picture: contours, the circularity W of seed paper Eq. (6), an ellipse test beside it, and a
// sub-pixel centre from the grey levels.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/image/image.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

struct CircleOptions {
  double min_circularity = 0.84;  // W = 4 pi S / L^2, seed paper Eq. (6); 1 for a circle, 0.785 for a square
  double min_diameter_px = 7.0;   // geometric mean of the axes
  double max_diameter_px = 400.0;
};

// An outline that looks like a circle seen at an angle: an ellipse.
struct DetectedCircle {
  ImagePoint centre;              // px, centre of the imaged ellipse
  double u_centre_px = 0.0;       // standard uncertainty of each coordinate
  double diameter_px = 0.0;       // geometric mean of the ellipse's axes
  double axis_ratio = 1.0;        // minor / major
  double angle_rad = 0.0;         // of the major axis, from image x towards image y
  double circularity = 0.0;       // W
  double ellipse_residual = 0.0;  // rms distance of the outline from the ellipse / diameter
  double contrast = 0.0;          // grey levels, inside minus outside
  double background = 0.0;        // grey level just outside
};

struct RejectedOutline {
  ImagePoint centre;
  double diameter_px = 0.0;
  double circularity = 0.0;
  std::string why;  // "W = 0.79, need 0.84", "not an ellipse: ...", ...
};

struct CircleSearch {
  std::vector<DetectedCircle> circles;    // in order of y, then x
  std::vector<RejectedOutline> rejected;  // outlines of plausible size that failed a test
  [[nodiscard]] double best_rejected_circularity() const;
};

// Every circle in the picture, dark on light or light on dark.
[[nodiscard]] CircleSearch find_circles(const LumaView& luma, const CircleOptions& options);

// The circle near a predicted place: searches only a window of +-reach_px + diameter round it. Same centre as
// find_circles gives for the same circle. Empty when nothing there passes.
[[nodiscard]] std::vector<DetectedCircle> find_circles_near(const LumaView& luma, ImagePoint predicted,
                                                            double diameter_px, double reach_px,
                                                            const CircleOptions& options);

}  // namespace moiregauge::internal
