// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/circles/circle_verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "moiregauge/detection/circles/disc_fit.h"
#include "moiregauge/detection/circles/traced_outline.h"

namespace moiregauge::internal::markers_detail {
namespace {

// Limits of the rms distance from the ellipse, added in quadrature. A square has 0.052 of its equivalent diameter, a
// hexagon 0.017, a roughly printed disc 0.01. The limit in px is for discs of about 10 px, which sharpening in the
// camera or a pixel of the printer makes rough.
constexpr double kMaxResidualShare = 0.02;   // relative to the diameter
constexpr double kMaxResidualPx = 0.15;      // px
constexpr double kMinContrastInNoise = 3.0;  // in rms residuals: a disc of less contrast may be noise (chosen)

std::string two_decimals(const char* before, double value, const char* between, double limit) {
  char text[96];
  std::snprintf(text, sizeof text, "%s%.2f%s%.2f", before, value, between, limit);
  return text;
}

// Returns the reason for rejecting an outline; empty if it is a circle.
std::string problem_with(const TracedOutline& traced, const CircleOptions& options, double ellipse_slack) {
  const double diameter = traced.ellipse.diameter();
  if (!traced.problem.empty()) return traced.problem;
  if (diameter < options.min_diameter_px)
    return two_decimals("too small, diameter ", diameter, " px of at least ", options.min_diameter_px);
  if (diameter > options.max_diameter_px)
    return two_decimals("too large, diameter ", diameter, " px of at most ", options.max_diameter_px);
  if (!(traced.circularity > options.min_circularity)) {
    return two_decimals("not round enough, W = ", traced.circularity, " of at least ", options.min_circularity);
  }
  const double limit = ellipse_slack * std::hypot(kMaxResidualShare * diameter, kMaxResidualPx);
  if (traced.residual_px > limit)
    return two_decimals("not an ellipse, residual ", traced.residual_px, " px rms of at most ", limit);
  return {};
}

}  // namespace

CircleVerdict judge_circle(const LumaView& luma, const Ellipse& start, const CircleOptions& options,
                           double ellipse_slack) {
  const TracedOutline traced = trace_outline(luma, start);
  CircleVerdict verdict{std::nullopt, traced.circularity, problem_with(traced, options, ellipse_slack)};
  if (!verdict.why.empty()) return verdict;
  const auto fitted = fit_disc(luma, traced);
  if (!fitted) {
    verdict.why = "its grey levels are not those of a disc";
    return verdict;
  }
  if (std::abs(traced.contrast) < kMinContrastInNoise * fitted->residual) {
    verdict.why = "too faint for the noise";
    return verdict;
  }
  const double diameter = fitted->ellipse.diameter();
  const auto shape = fitted->ellipse.shape();
  verdict.circle = DetectedCircle{.centre = {fitted->ellipse.centre.x(), fitted->ellipse.centre.y()},
                                  .u_centre_px = fitted->u_centre_px,
                                  .diameter_px = diameter,
                                  .axis_ratio = shape.axis_ratio,
                                  .angle_rad = shape.angle_rad,
                                  .circularity = std::min(traced.circularity, 1.0),
                                  .ellipse_residual = traced.residual_px / diameter,
                                  .contrast = traced.contrast,
                                  .background = traced.background};
  return verdict;
}

}  // namespace moiregauge::internal::markers_detail
