// SPDX-License-Identifier: Apache-2.0
// A marker's grating resampled into a square raster that lies along the print's own axes: what the two warps of the
// seed paper do (Figs. 3 and 5), for the markers' windows only, straight from the raw frame and with exact coordinates.
#pragma once

#include <tl/expected.hpp>

#include "moiregauge/geometry/view.h"
#include "moiregauge/image/image.h"
#include "moiregauge/image/spline.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Where a raster lies on the board. Its axis 0 is turned by angle_rad counter-clockwise from the board's x, its axis 1
// by 90 degrees more (so both grow as the board's x and y do when the angle is 0).
struct RasterPlan {
  BoardPoint centre;
  double angle_rad = 0.0;
  double pitch_mm = 0.0;      // period along both raster axes
  double step_mm = 0.0;       // raster pixel; chosen so that one pitch is exactly sampling_pitch_px of them
  int sampling_pitch_px = 0;  // T, raster pixels
  int region_px = 0;          // side of the averaged region, raster pixels
  int side_px = 0;            // region + 2 (T - 1), odd
  double clearance_mm = 0.0;  // how far the print may move before its edge comes into the raster
  bool reads_x = true;        // the print shows motion along raster axis 0
  bool reads_y = true;
};

struct RasterOptions {
  int region_px = 100;        // the paper's region, picture pixels (section 3.3)
  int sampling_pitch_px = 0;  // T in picture pixels; 0: the pitch in the picture, rounded
  double edge_px = 2.4;       // kept clear of the print's edge: 3 sigma of a PSF with its pixel box
};

enum class RasterFailure {
  kTooCoarse,     // under kMinPitchPx the fundamental is beyond what pixels can carry
  kPrintTooSmall  // the window of 2 T - 1 px does not fit the print
};

inline constexpr double kMinPitchPx = 2.5;

// Raster points per picture pixel along each axis. One would do for an upright cosine; an oblique binary print
// interpolated at one point a pixel folds its harmonics back into the fundamental (0.002 px at 20 deg; below 0.001 px
// with two).
inline constexpr int kOversampling = 2;

// The period along the axes on which the print's fundamental harmonics lie: the pitch, but for a checkerboard, whose
// fundamentals lie on the diagonals (k, k) and (k, -k), pitch / sqrt 2 along axes turned by 45 degrees.
[[nodiscard]] double fundamental_pitch_mm(const Grating& grating);

// `mm_per_px` in the picture's finest direction (View::finest_mm_per_px), so that no raster step skips a pixel: an
// oblique binary print would alias.
[[nodiscard]] tl::expected<RasterPlan, RasterFailure> plan_raster(const Grating& grating, double mm_per_px,
                                                                  const RasterOptions& options);

// Buffers that are kept from one raster to the next.
struct RasterWorkspace {
  Image<double> raster;
  Spline spline;
};

// Grey levels of `luma` at the raster's points, shifted on the board by `shift`, into work.raster.
// Returns false (and leaves the raster unspecified) when any point falls outside the picture.
[[nodiscard]] bool resample(const LumaView& luma, const View& view, const RasterPlan& plan, Extent<frame::Board> shift,
                            RasterWorkspace& work);

}  // namespace moiregauge::internal
