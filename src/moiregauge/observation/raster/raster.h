// SPDX-License-Identifier: Apache-2.0
// Plans the square window through which a marker's grating is read, along the grating's own axes. This replaces the two
// warps of the seed paper (Figs. 3 and 5) for the markers' windows only.
#pragma once

#include <tl/expected.hpp>

#include "moiregauge/site/site.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

// Position of a raster on the board. Axis 0 is rotated by angle_rad counter-clockwise from the board's x, and axis 1 by
// 90 degrees more. At angle 0 both grow as the board's x and y do.
struct RasterPlan {
  BoardPoint centre;
  double angle_rad = 0.0;
  double pitch_mm = 0.0;  // period along both raster axes
  // Raster pixel. One pitch is exactly sampling_pitch_px of them, unless the options state a sampling pitch.
  double step_mm = 0.0;
  int sampling_pitch_px = 0;  // T, raster pixels
  int region_px = 0;          // side of the averaged region, raster pixels
  int side_px = 0;            // region + 2 (T - 1), odd
  // Distance by which the grating may move before its edge enters the raster.
  double clearance_mm = 0.0;
  bool reads_x = true;  // the grating shows motion along raster axis 0
  bool reads_y = true;
};

struct RasterOptions {
  // Side of the averaged region, image pixels (section 3.3 of the paper).
  int region_px = 100;
  // T in image pixels. 0: the pitch in the image, rounded.
  int sampling_pitch_px = 0;
  // Clearance from the grating's edge: 3 sigma of a PSF with its pixel box.
  double edge_px = 2.4;
};

enum class RasterFailure {
  // A pitch below kMinPitchPx: pixels cannot resolve the fundamental.
  kTooCoarse,
  kPrintTooSmall  // the window of 2 T - 1 px exceeds the grating
};

// px. Pixels do not resolve a shorter fundamental. Chosen.
inline constexpr double kMinPitchPx = 2.5;

// Raster pixels per image pixel along each axis. They are the unit of the plan. The phase is read from the image's own
// pixels.
inline constexpr int kOversampling = 2;

// Returns the period along the axes of the grating's fundamentals, mm. It is the pitch, except for a checkerboard. The
// fundamentals of a checkerboard are on the diagonals (k, k) and (k, -k), with pitch / sqrt 2 along axes rotated by 45
// degrees.
[[nodiscard]] double fundamental_pitch_mm(const Grating& grating);

// Plans the raster of a grating. `mm_per_px` is the scale in the image's finest direction (View::finest_mm_per_px).
// Then no raster step skips a pixel, which would alias an oblique binary grating.
// Fails: RasterFailure names the reason.
[[nodiscard]] tl::expected<RasterPlan, RasterFailure> plan_raster(const Grating& grating, double mm_per_px,
                                                                  const RasterOptions& options);

}  // namespace moiregauge::internal
