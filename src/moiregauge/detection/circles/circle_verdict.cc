// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/circles/circle_verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "moiregauge/detection/circles/disc_fit.h"
#include "moiregauge/detection/circles/traced_outline.h"

namespace moiregauge::internal::markers_detail {
namespace {

// rms distance from the ellipse: a square has 0.052 of its equivalent diameter, a hexagon 0.017, a roughly printed disc
// 0.01; the pixel share is for discs of 10 px, sharpened by a camera or rough by a pixel of the print.
constexpr double kMaxResidualShare = 0.02;
constexpr double kMaxResidualPx = 0.15;
constexpr double kMinContrastInNoise = 3.0;  // of the fit's residual: below, the disc is not there

std::string two_decimals(const char* before, double value, const char* between, double limit) {
  char text[96];
  std::snprintf(text, sizeof text, "%s%.2f%s%.2f", before, value, between, limit);
  return text;
}

// Why an outline is no circle; empty when it is one.
std::string problem_with(const TracedOutline& traced, const CircleOptions& options, double ellipse_slack) {
  const double diameter = traced.ellipse.diameter();
  if (!traced.problem.empty()) return traced.problem;
  if (diameter < options.min_diameter_px)
    return two_decimals("diameter ", diameter, " px, need ", options.min_diameter_px);
  if (diameter > options.max_diameter_px)
    return two_decimals("diameter ", diameter, " px, limit ", options.max_diameter_px);
  if (!(traced.circularity > options.min_circularity)) {
    return two_decimals("W = ", traced.circularity, ", need > ", options.min_circularity);
  }
  const double limit = ellipse_slack * std::hypot(kMaxResidualShare * diameter, kMaxResidualPx);
  if (traced.residual_px > limit)
    return two_decimals("not an ellipse: off by ", traced.residual_px, " px rms, limit ", limit);
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
    verdict.why = "its grey levels fit no disc";
    return verdict;
  }
  if (std::abs(traced.contrast) < kMinContrastInNoise * fitted->residual) {
    verdict.why = "lost in noise";
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
