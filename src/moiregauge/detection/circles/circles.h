// SPDX-License-Identifier: Apache-2.0
// Detects circular markers in an image: outlines, circularity W (paper Eq. 6), distance from an ellipse, and a sub-
// pixel centre fitted to the grey levels.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/image/image.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

struct CircleOptions {
  double min_circularity = 0.84;  // W = 4 pi S / L^2, paper Eq. (6); 1 for a circle, 0.785 for a square
  double min_diameter_px = 7.0;   // geometric mean of the axes, as max_diameter_px
  double max_diameter_px = 400.0;
};

// Ellipse in the image that may be a circle viewed at an angle.
struct DetectedCircle {
  ImagePoint centre;              // px, centre of the imaged ellipse
  double u_centre_px = 0.0;       // px, standard uncertainty (k = 1) of each coordinate
  double diameter_px = 0.0;       // px, geometric mean of the ellipse's axes
  double axis_ratio = 1.0;        // minor / major
  double angle_rad = 0.0;         // rad, of the major axis, from image x towards image y
  double circularity = 0.0;       // W
  double ellipse_residual = 0.0;  // rms distance of the outline from the ellipse / diameter
  double contrast = 0.0;          // grey levels, inside minus outside
  double background = 0.0;        // grey level just outside
};

struct RejectedOutline {
  ImagePoint centre;         // px
  double diameter_px = 0.0;  // px
  double circularity = 0.0;  // smaller W of the digitised and the sub-pixel outline
  std::string why;           // "W = 0.79, need 0.84", "not an ellipse: ...", ...
};

struct CircleSearch {
  std::vector<DetectedCircle> circles;    // sorted by y, then x
  std::vector<RejectedOutline> rejected;  // outlines of plausible size that failed a test
  [[nodiscard]] double best_rejected_circularity() const;
};

// Detects all circles in the image, dark on light or light on dark.
[[nodiscard]] CircleSearch find_circles(const LumaView& luma, const CircleOptions& options);

// Detects the circles within reach_px of a predicted position, nearest first. Searches a window of +-(reach_px +
// diameter_px + 4) px and diameters within a factor of 1.5. Returns the same centre as find_circles for the same
// circle, within 0.05 of its standard uncertainty. Empty if no circle passes.
[[nodiscard]] std::vector<DetectedCircle> find_circles_near(const LumaView& luma, ImagePoint predicted,
                                                            double diameter_px, double reach_px,
                                                            const CircleOptions& options);

}  // namespace moiregauge::internal
