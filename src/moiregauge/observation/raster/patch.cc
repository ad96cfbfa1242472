// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/raster/patch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "moiregauge/observation/raster/lines_region.h"
#include "moiregauge/observation/raster/noise.h"
#include "moiregauge/phase/sampling_moire/sampling_moire.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Largest u of a phase. A worse one belongs to noise: that of pure noise is about 1 rad. Chosen.
constexpr double kMaxPhaseUncertainty = 0.1;  // rad

PixelNoise noise_round(const LumaView& luma, int bits, const View& view, const RasterPlan& plan,
                       Extent<frame::Board> shift) {
  const double half = 0.5 * plan.side_px * plan.step_mm;
  const ImagePoint a = view(plan.centre + shift + Extent<frame::Board>{-half, half});
  const ImagePoint b = view(plan.centre + shift + Extent<frame::Board>{half, -half});
  const int x0 = static_cast<int>(std::min(a.x, b.x)), x1 = static_cast<int>(std::max(a.x, b.x));
  const int y0 = static_cast<int>(std::min(a.y, b.y)), y1 = static_cast<int>(std::max(a.y, b.y));
  return pixel_noise(luma, bits, x0, y0, x1 - x0, y1 - y0);
}

// Smallest cosine of the angle between a board axis and the normal of the lines, at 1.5 deg. Lines show movement across
// themselves only. At 1.5 deg, 0.026 of the movement along them appears as movement along that axis. Beyond this limit
// neither axis is known. A grating is mounted to 0.3 deg. Chosen.
constexpr double kUpright = 0.99966;

// Returns u of a plane's slope over a side of n points, whose mean has the uncertainty u: u sqrt(12) / n.
double slope_uncertainty(double u_mean, double side) { return side > 1.0 ? u_mean * std::sqrt(12.0) / side : kNaN; }

}  // namespace

PatchReading read_patch(const LumaView& luma, int bits, const View& view, const RasterPlan& plan,
                        Extent<frame::Board> shift, PatchWorkspace& work) {
  PatchReading reading;
  reading.phase_rad = reading.u_phase_rad = reading.modulation = {kNaN, kNaN};
  reading.gradient = {{{kNaN, kNaN}, {kNaN, kNaN}}};
  reading.u_gradient = kNaN;
  if (!resample(luma, view, plan, shift, work.raster)) return reading;
  const PixelNoise noise = noise_round(luma, bits, view, plan, shift);
  reading.noise_sigma = noise.sigma;
  reading.clipped_share = noise.clipped_share;
  // The raster contains the information of the image's pixels under it, not that of its own points.
  const double step_px = plan.step_mm / view.mm_per_px(plan.centre + shift);
  const double pitch_px = plan.pitch_mm / plan.step_mm;
  const double mm_per_rad = plan.pitch_mm / kTwoPi;
  reading.valid = true;
  double straightness = 0.0;
  for (std::size_t a = 0; a < 2; ++a) {
    if (!(a == 0 ? plan.reads_x : plan.reads_y)) continue;
    const Axis axis = a == 0 ? Axis::kX : Axis::kY;
    const FringeField field = sampling_moire(work.raster.raster.view(), axis, plan.sampling_pitch_px);
    const bool of_lines = plan.reads_x != plan.reads_y;
    const LinesRegion lines = of_lines ? region_mean_of_lines(field, axis, pitch_px, plan.region_px)
                                       : LinesRegion{region_mean(field, axis, pitch_px, plan.region_px), 1.0};
    const RegionPhase& region = lines.phase;
    const double u = region.valid ? region_mean_uncertainty(noise.sigma, region.modulation, plan.sampling_pitch_px,
                                                            pitch_px, plan.region_px) /
                                        step_px / std::sqrt(lines.share)
                                  : kNaN;
    if (!(u < kMaxPhaseUncertainty)) {
      reading.valid = false;
      continue;
    }
    reading.phase_rad[a] = region.phase_rad;
    reading.modulation[a] = region.modulation;
    reading.u_phase_rad[a] = u;
    const double per_px = -mm_per_rad / plan.step_mm;
    reading.gradient[a] = {per_px * region.gradient_x_rad_per_px, per_px * region.gradient_y_rad_per_px};
    reading.u_gradient =
        slope_uncertainty(reading.u_phase_rad[a] * mm_per_rad, lines.share * plan.region_px * plan.step_mm);
    reading.u_straightness_mm =
        mm_per_rad / step_px *
        region_mean_uncertainty(noise.sigma, region.modulation, plan.sampling_pitch_px, pitch_px, 1);
    straightness = std::max(straightness, region.straightness_rad * mm_per_rad);
  }
  reading.straightness_mm = straightness;
  return reading;
}

bool is_lost(const PatchReading& then, const PatchReading& now) {
  for (std::size_t a = 0; a < 2; ++a) {
    if (now.modulation[a] < kLostModulation * then.modulation[a]) return true;
  }
  return false;
}

bool is_bent(const RasterPlan& plan, const PatchReading& then, const PatchReading& now, double lag_mm) {
  if (now.straightness_mm > kBentLattice * plan.pitch_mm + then.straightness_mm + 5.0 * now.u_straightness_mm + lag_mm)
    return true;
  const double allowed = kStretchedLattice + 5.0 * std::hypot(then.u_gradient, now.u_gradient) + lag_mm / plan.pitch_mm;
  for (std::size_t a = 0; a < 2; ++a) {
    for (std::size_t b = 0; b < 2; ++b) {
      if (std::abs(now.gradient[a][b] - then.gradient[a][b]) > allowed)
        return true;  // NaN (not measured) counts as not bent
    }
  }
  return false;
}

Extent<frame::Board> board_from_raster(const RasterPlan& plan, double along_0, double along_1) {
  const double c = std::cos(plan.angle_rad), s = std::sin(plan.angle_rad);
  return {c * along_0 - s * along_1, s * along_0 + c * along_1};
}

std::array<double, 2> raster_from_board(const RasterPlan& plan, Extent<frame::Board> d) {
  const double c = std::cos(plan.angle_rad), s = std::sin(plan.angle_rad);
  return {c * d.x + s * d.y, -s * d.x + c * d.y};
}

bool shows_an_axis(const RasterPlan& plan) {
  if (plan.reads_x && plan.reads_y) return true;
  return std::max(std::abs(std::cos(plan.angle_rad)), std::abs(std::sin(plan.angle_rad))) > kUpright;
}

Extent<frame::Board> displacement_between(const RasterPlan& plan, const PatchReading& from, const PatchReading& to) {
  const double mm_per_rad = plan.pitch_mm / kTwoPi;
  const double d0 = plan.reads_x ? -mm_per_rad * wrapped(to.phase_rad[0] - from.phase_rad[0]) : kNaN;
  const double d1 = plan.reads_y ? -mm_per_rad * wrapped(to.phase_rad[1] - from.phase_rad[1]) : kNaN;
  // A grating of lines along a board axis must not spoil the axis that it shows.
  if (std::isnan(d0) || std::isnan(d1)) {
    const double c = std::cos(plan.angle_rad), s = std::sin(plan.angle_rad);
    const double known = std::isnan(d0) ? d1 : d0;
    const Extent<frame::Board> along = std::isnan(d0) ? Extent<frame::Board>{-s, c} : Extent<frame::Board>{c, s};
    return {std::abs(along.x) > kUpright ? known * along.x : kNaN,
            std::abs(along.y) > kUpright ? known * along.y : kNaN};
  }
  return board_from_raster(plan, d0, d1);
}

Extent<frame::Board> displacement_at(const RasterPlan& plan, const PatchReading& from, const PatchReading& to,
                                     Extent<frame::Board> shift) {
  // The raster moves with the window, so it reads the grating's displacement minus the window's own.
  return shift + displacement_between(plan, from, to);
}

}  // namespace moiregauge::internal
