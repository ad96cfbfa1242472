// SPDX-License-Identifier: Apache-2.0
// Demodulation without a warp: every raw pixel of a patch is compared with the print's template at the print
// coordinates that a map gives it, and least squares corrects the map (docs/methods/precise.md).
//
//   I(p) = b0 + bu u + bv v + (g0 + gu u + gv v) t( X(p) + dX(p), Y(p) + dY(p) ) + hx t_XX + hy t_YY + noise
//
// hx, hy: a little more or less blur than the template has, from focus, motion or a nearer camera.
// p a pixel, (u, v) its place in the patch, X, Y the map's print coordinates, dX, dY biquadratic in (u, v): as many
// unknowns as 3 x 3 points with two coordinates, so these points carry all that the patch tells, in rows of one
// information matrix.
#pragma once

#include <array>

#include <Eigen/Core>
#include <tl/expected.hpp>

#include "moiregauge/geometry/homography.h"
#include "moiregauge/image/image.h"
#include "moiregauge/phase/print_template.h"

namespace moiregauge {

using PrintFromImage = Homography<frame::Print, frame::Image>;
using PrintFromPrint = Homography<frame::Print, frame::Print>;

// The pixels that count: |X - centre.x| <= half_x, |Y - centre.y| <= half_y in pitches, the print's edge left out.
struct PatchWindow {
  PrintPoint centre;
  double half_x = 0.0;
  double half_y = 0.0;
};

// Pixels, ends included.
struct PixelBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};
// Round the window's image, a pixel to spare on every side; it may reach beyond the picture.
[[nodiscard]] PixelBox box_round(const Homography<frame::Image, frame::Print>& image_from_print, const PatchWindow& w);

struct PatchFitOptions {
  int passes = 3;       // fixed: same bits for the same pixels. From 0.1 pitch two reach the fixed point
  int row_step = 1;     // all passes but the last look at every row_step-th row only
  bool along_x = true;  // the print shows motion along its x
  bool along_y = true;
};

inline constexpr int kPatchPoints = 9;
using PatchInformation = Eigen::Matrix<double, 2 * kPatchPoints, 2 * kPatchPoints>;

struct PatchFit {
  std::array<ImagePoint, kPatchPoints> image;  // px, as displayed; 3 x 3, x fastest, from low to high print coordinates
  std::array<PrintPoint, kPatchPoints> print;  // what each of them shows, pitches
  // Inverse covariance of the print coordinates (x of all nine, then y), per pitch^2; zero for an axis not shown.
  PatchInformation information = PatchInformation::Zero();
  // Light and contrast relative to the template, each with its slopes per px from `middle`.
  ImagePoint middle;
  std::array<double, 3> light{};  // grey levels
  std::array<double, 3> gain{};
  [[nodiscard]] double background(ImagePoint p) const { return plane(light, p); }
  [[nodiscard]] double contrast(ImagePoint p) const { return plane(gain, p); }
  double sigma = 0.0;      // grey levels, rms residual of one pixel
  // Amplitudes of the first harmonics along x and y relative to the template's: contrast and blur together.
  std::array<double, 2> fundamental{};
  double last_step = 0.0;  // pitches, the largest correction of the last pass at any point
  int pixels = 0;

 private:
  [[nodiscard]] double plane(const std::array<double, 3>& c, ImagePoint p) const {
    return c[0] + c[1] * (p.x - middle.x) + c[2] * (p.y - middle.y);
  }
};

enum class PatchFitFailure {
  kOutsidePicture,  // part of the window is not in the picture
  kTooFewPixels,
  kNoPattern  // no contrast, or the window does not determine the points
};

[[nodiscard]] tl::expected<PatchFit, PatchFitFailure> fit_patch(const LumaView& luma, const PrintFromImage& start,
                                                                const PatchWindow& window, const PrintTemplate& print,
                                                                const PatchFitOptions& options);

}  // namespace moiregauge
