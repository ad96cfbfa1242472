// SPDX-License-Identifier: Apache-2.0
// Demodulation without a warp: every raw pixel of a patch is compared with the print's template at the print
// coordinates that a map gives it, and least squares corrects the map (docs/methods/precise.md).
//
//   I(p) = b0 + bu u + bv v + (g0 + gu u + gv v) t( X(p) + dX(p), Y(p) + dY(p) ) + hx t_XX + hy t_YY + noise
//
// hx, hy: a little more or less blur than the template has, from focus, motion or a nearer camera.
// p a pixel, (u, v) its place in the window, X, Y the map's print coordinates, dX, dY biquadratic in (u, v): as many
// unknowns as 3 x 3 points with two coordinates, so these points carry all that the patch tells, in rows of one
// information matrix.
#pragma once

#include <array>

#include <tl/expected.hpp>

#include "moiregauge/phase/fit/patch_pass.h"
#include "moiregauge/phase/fit/patch_system.h"

namespace moiregauge::internal {

// Round the window's image, a pixel to spare on every side; it may reach beyond the picture.
[[nodiscard]] PixelBox box_round(const Homography<frame::Image, frame::Print>& image_from_print, const PatchWindow& w);

struct PatchFit {
  std::array<ImagePoint, kPatchPoints> image;  // px, as displayed; 3 x 3, x fastest, from low to high print coordinates
  std::array<PrintPoint, kPatchPoints> print;  // what each of them shows, pitches
  // Inverse covariance of the print coordinates (x of all nine, then y), per pitch^2; zero for an axis not shown.
  PatchInformation information = PatchInformation::Zero();
  // Light and contrast relative to the template, across the window as it was seen.
  Homography<frame::Window, frame::Image> window_from_image;
  PatchPlane light{};  // grey levels
  PatchPlane gain{};
  [[nodiscard]] double background(ImagePoint p) const { return plane(light, p); }
  [[nodiscard]] double contrast(ImagePoint p) const { return plane(gain, p); }
  double sigma = 0.0;  // grey levels, rms residual of one pixel
  // Amplitudes of the first harmonics along x and y relative to the template's: contrast and blur together.
  std::array<double, 2> fundamental{};
  double last_step = 0.0;  // pitches, the largest correction of the last pass at any point
  int pixels = 0;

 private:
  [[nodiscard]] double plane(const PatchPlane& c, ImagePoint p) const {
    const auto at = window_from_image(p);
    return c[0] + c[1] * at.x + c[2] * at.y;
  }
};

enum class PatchFitFailure {
  kOutsidePicture,  // part of the window is not in the picture
  kTooFewPixels,
  kNoPattern  // no contrast, or the window does not determine the points
};

// What is known of a patch from the frame in which its print was learned.
struct PatchAtRest {
  PatchSystem system;
  PatchPlane light{}, gain{};
};
struct FirstFit {
  PatchFit fit;
  PatchAtRest at_rest;
};

// Nothing known beforehand: normal equations are made in every pass.
[[nodiscard]] tl::expected<FirstFit, PatchFitFailure> fit_patch(const LumaView& luma, const PrintFromImage& start,
                                                                const PatchWindow& window, const PrintTemplate& print,
                                                                const PatchFitOptions& options);

enum class Rows {
  kSome,  // every options.row_step-th: a wider information, in a fraction of the time
  kAll
};

// The same from what is known: the patch is moved as a whole, by some of the rows, until it comes near; then passes
// over all rows until its points stand.
[[nodiscard]] tl::expected<PatchFit, PatchFitFailure> follow_patch(const LumaView& luma, const PrintFromImage& start,
                                                                   const PatchWindow& window,
                                                                   const PrintTemplate& print,
                                                                   const PatchFitOptions& options,
                                                                   const PatchAtRest& at_rest, Rows rows = Rows::kAll);

}  // namespace moiregauge::internal
