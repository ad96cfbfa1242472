// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/raster/raster.h"

#include <algorithm>
#include <cmath>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Returns the side of the largest upright square inside a w x h grating that is rotated by `angle` against it.
double inscribed_side(double width, double height, double angle) {
  return std::min(width, height) / (std::abs(std::cos(angle)) + std::abs(std::sin(angle)));
}

// Returns the length over which the grating repeats, mm. A pattern of dots about a dot ends with its last whole one,
// plus half a pitch of paper. The stated size may be larger: 4 pitches contain 3 dots.
double periodic_part(const Grating& grating, double size_mm) {
  if (grating.pattern != Pattern::kDots) return size_mm;
  const double last = std::floor(0.5 * size_mm / grating.pitch_mm - 0.25 + 1e-9);
  return std::min(size_mm, (2.0 * last + 1.0) * grating.pitch_mm);
}

}  // namespace

double fundamental_pitch_mm(const Grating& grating) {
  return grating.pattern == Pattern::kCheckerboard ? grating.pitch_mm / std::sqrt(2.0) : grating.pitch_mm;
}

tl::expected<RasterPlan, RasterFailure> plan_raster(const Grating& grating, double mm_per_px,
                                                    const RasterOptions& options) {
  const bool diagonal = grating.pattern == Pattern::kCheckerboard;
  RasterPlan plan;
  plan.centre = grating.centre;
  plan.angle_rad = grating.angle_rad + (diagonal ? kPi / 4.0 : 0.0);
  plan.pitch_mm = fundamental_pitch_mm(grating);
  plan.reads_x = grating.pattern != Pattern::kLinesY;
  plan.reads_y = grating.pattern != Pattern::kLinesX;
  const double pitch_px = plan.pitch_mm / mm_per_px;
  if (!(pitch_px >= kMinPitchPx)) return tl::unexpected(RasterFailure::kTooCoarse);
  const int given = options.sampling_pitch_px;
  plan.sampling_pitch_px = kOversampling * (given > 0 ? given : std::max(3, static_cast<int>(std::lround(pitch_px))));
  plan.step_mm = given > 0 ? mm_per_px / kOversampling : plan.pitch_mm / plan.sampling_pitch_px;
  const double print_px = inscribed_side(periodic_part(grating, grating.width_mm),
                                         periodic_part(grating, grating.height_mm), diagonal ? kPi / 4.0 : 0.0) /
                          plan.step_mm;
  const int support = 2 * (plan.sampling_pitch_px - 1);
  // A grating that contains the window without its clear edge is still read, because the outermost taps have almost no
  // weight.
  if (print_px < support + 1) return tl::unexpected(RasterFailure::kPrintTooSmall);
  const double room = print_px - support - 2.0 * kOversampling * options.edge_px;
  const int region = std::clamp(static_cast<int>(room), 1, kOversampling * options.region_px);
  plan.region_px = region - (1 - region % 2);  // odd, so that the raster has a centre pixel
  plan.side_px = plan.region_px + support;
  plan.clearance_mm = std::max(0.0, 0.5 * (print_px - plan.side_px) - kOversampling * options.edge_px) * plan.step_mm;
  return plan;
}

}  // namespace moiregauge::internal
