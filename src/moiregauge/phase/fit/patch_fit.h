// SPDX-License-Identifier: Apache-2.0
// Fits one grating to raw pixels, without a warp: least squares corrects the map from image to grating coordinates.
// Method and limits are in docs/methods/precise/fit.md. The model predicts the grey level of pixel p.
//
//     I(p) = b(u, v) + g(u, v) [ t(X + dX, Y + dY) + hx t_XX + hy t_YY + w (t_X^2 + t_Y^2) ] + noise
//     b = b0 + bu u + bv v    light, grey levels
//     g = g0 + gu u + gv v    contrast relative to the template t, 1
//     hx, hy                  change of blur along X and Y, pitch^2 (half the change of the PSF's variance)
//     w                       width of the lines, pitch^2 per grey level of t
//     dX, dY                  correction of the map, biquadratic in (u, v), pitches
//
// (X, Y) is the map's grating coordinate of p, and (u, v) its position in the window, -1 to 1. The field (dX, dY) has
// 18 unknowns, as many as nine points have coordinates. The nine points and their information matrix therefore contain
// all information of the pixels. w is fitted only if PatchFitOptions::has_width is set.
#pragma once

#include <array>

#include <tl/expected.hpp>

#include "moiregauge/phase/fit/patch_pass.h"
#include "moiregauge/phase/fit/patch_system.h"

namespace moiregauge::internal {

// Returns the pixels around the window's image, with a margin of a pixel or more. The box may extend beyond the image.
[[nodiscard]] PixelBox box_round(const Homography<frame::Image, frame::Print>& image_from_print, const PatchWindow& w);

struct PatchFit {
  std::array<ImagePoint, kPatchPoints> image;  // px, as displayed: 3 x 3 points, X fastest, from low to high X and Y
  std::array<PrintPoint, kPatchPoints> print;  // grating coordinate of each of them, pitches
  // Inverse covariance of the grating coordinates (X of all nine, then Y), 1/pitch^2. Zero for an axis that is not
  // shown.
  PatchInformation information = PatchInformation::Zero();
  // Window coordinates of an image point in this frame, for the planes of light and contrast.
  Homography<frame::Window, frame::Image> window_from_image;
  PatchPlane light{};  // grey levels
  // Contrast relative to the template, 1.
  PatchPlane gain{};
  // Returns the light at an image point, grey levels.
  [[nodiscard]] double background(ImagePoint p) const { return plane(light, p); }
  // Returns the contrast at an image point relative to the template, 1.
  [[nodiscard]] double contrast(ImagePoint p) const { return plane(gain, p); }
  struct LightAndContrast {
    double light, contrast;
  };
  // Returns both at once.
  [[nodiscard]] LightAndContrast light_and_contrast(ImagePoint p) const {
    const auto at = window_from_image(p);
    return {light[0] + light[1] * at.x + light[2] * at.y, gain[0] + gain[1] * at.x + gain[2] * at.y};
  }
  double sigma = 0.0;  // rms residual of a pixel, grey levels
  // Amplitudes of the fundamentals along X and Y relative to the template's, 1. They contain contrast and blur.
  std::array<double, 2> fundamental{};
  double last_step = 0.0;  // largest correction of a point in the last pass, pitches
  int pixels = 0;

 private:
  [[nodiscard]] double plane(const PatchPlane& c, ImagePoint p) const {
    const auto at = window_from_image(p);
    return c[0] + c[1] * at.x + c[2] * at.y;
  }
};

// Returns the map of a fit of this window: the homography nearest to its nine points. It is linear about the map of the
// last pass, which differs from it by that pass's step.
[[nodiscard]] PrintFromImage map_of(const PatchFit& fit, const PatchWindow& window);

// Grating to fit: a window in its coordinates, its template, and the options of the fit.
struct PatchToFit {
  const PatchWindow& window;
  const PrintTemplate& print;
  const PatchFitOptions& options;
};

enum class PatchFitFailure {
  kOutsidePicture,  // a part of the window is outside the image
  // Fewer than four pixels per unknown.
  kTooFewPixels,
  // No contrast, a window that does not determine the points, or a last step of 0.1 pitch or more.
  kNoPattern
};

// Normal equations, light (grey levels) and contrast (1) of a grating in the reference frame. Later frames use them.
struct PatchAtRest {
  PatchSystem system;
  PatchPlane light{}, gain{};
};
struct FirstFit {
  PatchFit fit;
  PatchAtRest at_rest;
};

// Fits a grating from the map `start`, with normal equations of its own in each of `patch.options.passes` passes.
// Fails: PatchFitFailure names the reason.
// Error: `fit.information`. u of a common shift is 1.04 times the bound of Rife and Boorstyn (1974).
[[nodiscard]] tl::expected<FirstFit, PatchFitFailure> fit_patch(const LumaView& luma, const PrintFromImage& start,
                                                                const PatchToFit& patch);

enum class Rows {
  kSome,  // every options.row_step-th row: a fraction of the time, a larger u
  kAll
};

// Fits a grating of a later frame with the normal equations of the reference frame. First shifts the window as a whole,
// by half the pixels of every row_step-th row. Then repeats passes over all rows until the points converge. If they do
// not, it uses the frame's own normal equations. With Rows::kSome only the shift is fitted, by all pixels of these rows.
// Fails and errs as fit_patch does.
[[nodiscard]] tl::expected<PatchFit, PatchFitFailure> follow_patch(const LumaView& luma, const PrintFromImage& start,
                                                                   const PatchToFit& patch, const PatchAtRest& at_rest,
                                                                   Rows rows = Rows::kAll);

}  // namespace moiregauge::internal
