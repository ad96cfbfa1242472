// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/raster.h"

#include <algorithm>
#include <cmath>

#include "moiregauge/units/units.h"

namespace moiregauge {
namespace {

// Side of the largest upright square that fits a w x h print when turned by `angle` against it.
double inscribed_side(double width, double height, double angle) {
  return std::min(width, height) / (std::abs(std::cos(angle)) + std::abs(std::sin(angle)));
}

// Cubic convolution, a = -1/2 (R. Keys 1981, doi:10.1109/TASSP.1981.1163711). The seed paper interpolates linearly; that
// damps the fringe by up to omega^2 / 8 between pixels, a ripple which beats with an oblique pixel grid and costs 0.002 px
// at 20 deg. Cubic damping is of order omega^4.
struct CubicWeights {
  double w[4];
  explicit CubicWeights(double t)
      : w{((-0.5 * t + 1.0) * t - 0.5) * t, (1.5 * t - 2.5) * t * t + 1.0, ((-1.5 * t + 2.0) * t + 0.5) * t,
          (0.5 * t - 0.5) * t * t} {}
};

template <typename Grey>
double cubic(const ImageView<Grey>& picture, int x, int y, double fx, double fy) {
  const CubicWeights across(fx), down(fy);
  double sum = 0.0;
  for (int j = 0; j < 4; ++j) {
    const Grey* p = picture.data + (y + j - 1) * picture.stride + x - 1;
    sum += down.w[j] * (across.w[0] * p[0] + across.w[1] * p[1] + across.w[2] * p[2] + across.w[3] * p[3]);
  }
  return sum;
}

template <typename Grey>
bool resample_from(const ImageView<Grey>& picture, const View& view, const RasterPlan& plan, Extent<frame::Board> shift,
                   Image<double>& out) {
  const double c = std::cos(plan.angle_rad) * plan.step_mm;
  const double s = std::sin(plan.angle_rad) * plan.step_mm;
  const double middle = 0.5 * (plan.side_px - 1);
  const BoardPoint centre = plan.centre + shift;
  if (out.width() != plan.side_px || out.height() != plan.side_px) out = Image<double>(plan.side_px, plan.side_px);
  for (int j = 0; j < plan.side_px; ++j) {
    const auto row = out.row(j);
    const double v = j - middle;
    for (int i = 0; i < plan.side_px; ++i) {
      const double u = i - middle;
      const ImagePoint p = view(BoardPoint{centre.x + c * u - s * v, centre.y + s * u + c * v});
      const int x = static_cast<int>(std::floor(p.x));
      const int y = static_cast<int>(std::floor(p.y));
      if (!(x >= 1 && y >= 1 && x + 2 < picture.width && y + 2 < picture.height)) return false;
      row[static_cast<std::size_t>(i)] = cubic(picture, x, y, p.x - x, p.y - y);
    }
  }
  return true;
}

}  // namespace

double fundamental_pitch_mm(const Grating& grating) {
  return grating.pattern == Pattern::kCheckerboard ? grating.pitch_mm / std::sqrt(2.0) : grating.pitch_mm;
}

tl::expected<RasterPlan, RasterFailure> plan_raster(const Grating& grating, double mm_per_px, const RasterOptions& options) {
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
  const double print_px =
      inscribed_side(grating.width_mm, grating.height_mm, diagonal ? kPi / 4.0 : 0.0) / plan.step_mm;
  const int support = 2 * (plan.sampling_pitch_px - 1);
  // A print that holds the bare window but not its clear edge is still read: its outermost taps weigh next to nothing.
  if (print_px < support + 1) return tl::unexpected(RasterFailure::kPrintTooSmall);
  const double room = print_px - support - 2.0 * kOversampling * options.edge_px;
  const int region = std::clamp(static_cast<int>(room), 1, kOversampling * options.region_px);
  plan.region_px = region - (1 - region % 2);  // odd, so that the raster has a centre pixel
  plan.side_px = plan.region_px + support;
  plan.clearance_mm = std::max(0.0, 0.5 * (print_px - plan.side_px) - kOversampling * options.edge_px) * plan.step_mm;
  return plan;
}

bool resample(const LumaView& luma, const View& view, const RasterPlan& plan, Extent<frame::Board> shift,
              Image<double>& out) {
  return std::visit([&](const auto& picture) { return resample_from(picture, view, plan, shift, out); }, luma);
}

}  // namespace moiregauge
